//! What shadow looks like on a floor, and which bright cells are still floor.
//!
//! Where the lamp is hidden, only the rest of the light is left: a shadow is darker than lit floor by one
//! factor, its chroma is turned towards that of the rest, and it appears beside most boxes. So the colour
//! is taken that is found in most separate patches, not the one that fills most cells, which may be that of
//! one large box. With a lamp near by, lit floor grows brighter towards it while shadow does not; both
//! readings are tried. A highlight is brighter than the model but grows out of the floor without an edge.

use super::floor::{Feature, FloorModel, median};
use crate::geometry::Point;
use crate::vision::image::Raster;

/// Depths that are tried, natural logarithms.
const DEPTHS: std::ops::Range<i32> = 5..38;
const DEPTH_STEP: f32 = 0.04;
/// Depths that shadows have: the middle and the spread of the logarithm.
const USUAL_DEPTH: f32 = 0.65;
const DEPTH_SPREAD: f32 = 0.55;
/// How far shadow may differ from its mean depth, and turn in chroma, shares of the depth.
pub(crate) const DEPTH_TOLERANCE: f32 = 0.18;
const MOST_TURN: [f32; 2] = [0.25, 0.4];
/// Cells this many standard deviations from a shadow, and this many in brightness, may belong to it.
const SAME: f32 = 4.0;
const SAME_DEPTH: f32 = 1.5;
/// Cells this close to the border, metres, are blurred with it.
const BORDER_BLUR: f64 = 0.015;
/// Patches of shadow have at least this many square metres of cells whose neighbours are shadow too.
const LEAST_PATCH: f64 = 0.0012;
/// Cells that tell the chroma.
const LEAST_CELLS: usize = 12;
/// Readings of shadow differ in depth by this natural logarithm.
const OTHER_DEPTH: f32 = 0.3;
/// Neighbouring cells of a highlight differ by at most this (brightness, chroma, chroma).
const SMOOTH: Feature = [0.035, 0.03, 0.03];

/// Which readings of shadow are worth a closer look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Readings {
    /// So many at most.
    pub(crate) most: usize,
    /// Those whose score is at least this share of the best.
    pub(crate) least_score: f32,
}

/// How shadow differs from lit floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shadow {
    /// What is added to the lit floor's feature where that has its mean brightness.
    pub(crate) offset: Feature,
    /// The lit floor's mean brightness if shadow has the same brightness everywhere, else none.
    pub(crate) even: Option<f32>,
}

impl Shadow {
    /// What is added to a lit feature.
    pub(crate) fn at(&self, lit: Feature) -> Feature {
        let deeper = self.even.map_or(0.0, |mean| lit[0] - mean);
        let depth = (self.offset[0] - deeper).min(-0.05);
        let share = depth / self.offset[0];
        [depth, share * self.offset[1], share * self.offset[2]]
    }

    /// Whether another shadow is clearly deeper or less deep.
    fn differs(&self, other: &Self) -> bool {
        (self.offset[0] / other.offset[0]).ln().abs() > OTHER_DEPTH
    }
}

/// A coarse view of the floor: where each cell lies and its residual from the floor's model.
pub(crate) struct Residuals {
    pub(crate) points: Vec<Point>,
    /// Cells per metre.
    pub(crate) scale: f64,
    pub(crate) residuals: Raster<Feature>,
}

/// What shadow may look like, likeliest first; none if there is no shadow.
pub(crate) fn find(floor: &FloorModel, view: &Residuals, readings: Readings) -> Vec<Shadow> {
    let lit: Vec<f32> = view.points.iter().map(|&point| floor.lit(point)[0]).collect();
    let mean = median(&mut lit.clone());
    let mut tried: Vec<(f32, Shadow)> = Vec::new();
    let inside: Vec<bool> =
        view.points.iter().map(|&point| floor.inside(point) > BORDER_BLUR).collect();
    let shallowest = -DEPTH_STEP * DEPTHS.start as f32;
    for even in [None, Some(mean)] {
        let extra = |index: usize| even.map_or(0.0, |mean| lit[index] - mean);
        // Most cells are lit floor, too bright for any depth.
        let dark: Vec<Feature> = (view.residuals.cells().iter().enumerate())
            .map(|(index, seen)| (index, [seen[0] + extra(index), seen[1], seen[2]]))
            .filter(|&(index, seen)| {
                inside[index] && seen[0] < shallowest + reach(floor, shallowest) + 1e-3
            })
            .map(|(_, seen)| seen)
            .collect();
        for index in DEPTHS {
            let depth = -DEPTH_STEP * index as f32;
            let Some(shadow) = turned(&dark, floor, depth, even) else { continue };
            let usual = ((-depth / USUAL_DEPTH).ln() / DEPTH_SPREAD).powi(2) / 2.0;
            let score = patches(view, floor, shadow, &lit, &inside) * (-usual).exp();
            if score > 0.0 {
                tried.push((score, shadow));
            }
        }
    }
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    let least = readings.least_score * tried.first().map_or(0.0, |best| best.0);
    let mut found: Vec<Shadow> = Vec::new();
    for (_, shadow) in tried.into_iter().filter(|(score, _)| *score >= least) {
        if found.len() < readings.most && found.iter().all(|other| shadow.differs(other)) {
            found.push(shadow);
        }
    }
    found
}

/// How far the brightness of cells that tell the chroma of a depth may lie from it.
fn reach(floor: &FloorModel, depth: f32) -> f32 {
    (DEPTH_TOLERANCE * -depth).max(2.0 * floor.spread[0]) / 2.0
}

/// Shadow of a depth with the chroma that the cells of that depth have, from all `dark` cells.
fn turned(dark: &[Feature], floor: &FloorModel, depth: f32, even: Option<f32>) -> Option<Shadow> {
    let mut chroma: [Vec<f32>; 2] = Default::default();
    let reach = reach(floor, depth);
    for seen in dark {
        let near = (seen[0] - depth).abs() < reach;
        let plain = (0..2).all(|part| seen[part + 1].abs() < MOST_TURN[part] * -depth + 0.02);
        if near && plain {
            chroma.iter_mut().zip(&seen[1..]).for_each(|(list, &value)| list.push(value));
        }
    }
    let enough = chroma[0].len() >= LEAST_CELLS;
    let [c, d] = chroma.map(|mut list| median(&mut list));
    enough.then_some(Shadow { offset: [depth, c, d], even })
}

/// The sum of the square roots of the sizes of all patches of a shadow's colour.
fn patches(
    view: &Residuals,
    floor: &FloorModel,
    shadow: Shadow,
    lit: &[f32],
    inside: &[bool],
) -> f32 {
    let (width, height) = (view.residuals.width(), view.residuals.height());
    let core = Raster::from_fn(width, height, |column, row| {
        let index = row * width + column;
        let offset = shadow.at([lit[index], 0.0, 0.0]);
        let seen = view.residuals.cells()[index];
        let near = (seen[0] - offset[0]).abs()
            < DEPTH_TOLERANCE * -offset[0] + SAME_DEPTH * floor.spread[0];
        inside[index] && near && floor.tells_shadow(offset) && floor.off_shadow(seen, offset) < SAME
    });
    let inner = Raster::from_fn(width, height, |column, row| {
        let (x, y) = (column as i64, row as i64);
        [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]
            .into_iter()
            .all(|(i, j)| core.get(x + i, y + j) == Some(true))
    });
    let least = (LEAST_PATCH * view.scale * view.scale).max(4.0);
    let (regions, count) = inner.regions(true);
    let mut sizes = vec![0usize; count + 1];
    regions.cells().iter().for_each(|&region| sizes[region as usize] += 1);
    sizes
        .iter()
        .skip(1)
        .filter(|&&size| size as f64 >= least)
        .map(|&size| (size as f32).sqrt())
        .sum()
}

/// The cells brighter than the floor's model that grow out of it without an edge.
///
/// One place where a box and the floor happen to be equally bright must not open the box: around most of
/// a highlight the floor goes over into it smoothly.
pub(crate) fn highlights(floor: &FloorModel, view: &Residuals, sure: f32) -> Raster<bool> {
    let cells = view.residuals.cells();
    let lit = view.residuals.map(|residual| floor.difference_of(residual).lit < sure);
    let smooth = |a: usize, b: usize| {
        (0..3).all(|part| {
            (cells[a][part] - cells[b][part]).abs() < SMOOTH[part].max(floor.spread[part])
        })
    };
    let reached = lit.grown(|cell, next| {
        let dark = cells[next][0] <= -2.0 * floor.spread[0];
        !dark && smooth(cell, next)
    });
    let glow = Raster::from_fn(lit.width(), lit.height(), |column, row| {
        let cell = row * lit.width() + column;
        reached.cells()[cell] && !lit.cells()[cell]
    });
    let (patches, count) = glow.regions(true);
    let mut rims = vec![[0usize; 2]; count + 1];
    for (cell, &patch) in patches.cells().iter().enumerate().filter(|&(_, &patch)| patch > 0) {
        for next in lit.beside(cell).filter(|&next| lit.cells()[next]) {
            rims[patch as usize][usize::from(smooth(cell, next))] += 1;
        }
    }
    let edged = |patch: u32| patch > 0 && rims[patch as usize][0] > rims[patch as usize][1];
    let glows = patches.map(|patch| !edged(patch));
    Raster::from_fn(lit.width(), lit.height(), |column, row| {
        let cell = row * lit.width() + column;
        reached.cells()[cell] && glows.cells()[cell]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Arena;

    const ARENA: Arena = Arena { width: 2.0, height: 1.0 };
    const SCALE: f64 = 100.0;
    const TWO: Readings = Readings { most: 2, least_score: 0.3 };

    /// An even floor on which `residual` tells what differs from it.
    fn view(residual: impl Fn(Point) -> Feature) -> (FloorModel, Residuals) {
        let place = |i: usize| Point::new((i % 200) as f64 / SCALE, (i / 200) as f64 / SCALE);
        let points: Vec<Point> = (0..200 * 100).map(place).collect();
        let flat: Vec<(Point, Feature)> =
            points.iter().map(|&point| (point, [-0.5, 0.0, 0.0])).collect();
        let floor = FloorModel::fit(ARENA, &flat).unwrap();
        let residuals = Raster::from_fn(200, 100, |x, y| residual(points[y * 200 + x]));
        (floor, Residuals { points, scale: SCALE, residuals })
    }

    #[test]
    fn shadow_is_what_several_patches_share_not_the_largest_box() {
        let (floor, view) = view(|point| {
            let patch = |x: f64, y: f64, w: f64, h: f64| {
                point.x > x && point.x < x + w && point.y > y && point.y < y + h
            };
            match point {
                _ if patch(0.2, 0.2, 0.08, 0.12) => [-0.6, -0.02, -0.1],
                _ if patch(0.6, 0.6, 0.1, 0.12) => [-0.6, -0.02, -0.1],
                _ if patch(1.0, 0.3, 0.09, 0.12) => [-0.6, -0.02, -0.1],
                _ if patch(1.4, 0.4, 0.3, 0.4) => [-1.1, 0.05, 0.05],
                _ => [0.0; 3],
            }
        });
        let shadow = find(&floor, &view, TWO)[0];
        let offset = shadow.at([-0.5, 0.0, 0.0]);
        // The true depth lies within what counts as this shadow.
        assert!((offset[0] + 0.6).abs() < DEPTH_TOLERANCE * 0.6, "{shadow:?}");
        assert!((offset[2] + 0.1).abs() < 0.03, "{shadow:?}");
    }

    #[test]
    fn a_plain_floor_has_no_shadow() {
        let (floor, view) = view(|_| [0.0; 3]);
        assert_eq!(find(&floor, &view, TWO), []);
    }

    #[test]
    fn near_a_lamp_even_shadow_is_deeper() {
        let shadow = Shadow { offset: [-0.5, -0.05, -0.1], even: Some(-1.0) };
        assert_eq!(shadow.at([-1.0, 0.0, 0.0]), [-0.5, -0.05, -0.1]);
        let [depth, c, d] = shadow.at([-0.75, 0.0, 0.0]);
        assert!((depth + 0.75).abs() < 1e-6 && (c + 0.075).abs() < 1e-6 && (d + 0.15).abs() < 1e-6);
    }

    #[test]
    fn a_highlight_is_floor_and_a_bright_box_is_not() {
        let (floor, view) = view(|point| {
            let glow = (0.5 - point.distance(Point::new(0.6, 0.5))).max(0.0) as f32;
            let of_box = point.x > 1.5 && point.x < 1.8 && point.y > 0.3 && point.y < 0.6;
            [if of_box { 0.4 } else { glow }, 0.0, 0.0]
        });
        let reached = highlights(&floor, &view, 2.5);
        assert_eq!((reached.get(60, 50), reached.get(165, 45)), (Some(true), Some(false)));
    }

    #[test]
    fn a_bright_box_that_is_as_bright_as_the_floor_in_one_place_is_no_highlight() {
        let (floor, view) = view(|point| {
            let of_box = point.x > 1.5 && point.x < 1.8 && point.y > 0.3 && point.y < 0.6;
            // A streak on the floor leads up to the box's brightness.
            let streak = (point.y - 0.45).abs() < 0.02 && point.x <= 1.5;
            let rise = (0.4 - (1.5 - point.x)).clamp(0.0, 0.4) as f32;
            [if of_box { 0.4 } else { rise * f32::from(u8::from(streak)) }, 0.0, 0.0]
        });
        assert_eq!(highlights(&floor, &view, 2.5).get(165, 45), Some(false));
    }

    #[test]
    fn two_depths_are_two_readings_of_shadow() {
        let (floor, view) = view(|point| {
            let patch = |x: f64, y: f64| {
                point.x > x && point.x < x + 0.12 && point.y > y && point.y < y + 0.12
            };
            let depth = match () {
                () if patch(0.2, 0.2) || patch(0.6, 0.6) => -0.5,
                () if patch(1.0, 0.3) || patch(1.5, 0.5) => -1.0,
                () => 0.0,
            };
            [depth, 0.0, 0.0]
        });
        let mut depths: Vec<f32> =
            find(&floor, &view, TWO).iter().map(|one| one.offset[0]).collect();
        depths.sort_by(f32::total_cmp);
        let [deep, shallow] = depths[..] else { panic!("{depths:?}") };
        assert!((deep + 1.0).abs() < 0.2 && (shallow + 0.5).abs() < 0.1, "{depths:?}");
    }
}
