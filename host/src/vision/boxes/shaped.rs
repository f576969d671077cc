//! What upright boxes explain badly is taken by its own outline: turned boxes, discs, cut card.
//!
//! All cells of one connected patch that are neither floor nor shadow are held against the boxes that were
//! found there. Where boxes and patch differ by more than blur and a simple shape agrees clearly better, that
//! shape replaces the boxes. Metres in the arena frame;
//! patches are searched for in the plan view.
//!
//! Deviation: the paper's obstacles are upright rectangles alone [Alghannam, Sec. II.A].

use super::projection::LeaningBox;
use crate::geometry::{Arena, Point, Rect};
use crate::scene::Obstacle;
use crate::shape::{Polygon, Shape};
use crate::vision::image::{Raster, around};
use crate::vision::outline::{FittedShape, contour, fit};
use crate::vision::plan_view::PlanFrame;

/// Boxes that share this much of their area and a patch's, joined, explain the patch.
const WELL_EXPLAINED: f64 = 0.93;
/// Boxes that share less of it explain it poorly.
const POORLY_EXPLAINED: f64 = 0.7;
/// A shape replaces them if it shares so much more, where nothing leans.
const CLEARLY_BETTER: f64 = 0.03;
/// The same where nothing leans and no light casts shadows.
const PLAINLY_EXPLAINED: f64 = 0.97;
const PLAINLY_BETTER: f64 = 0.01;
/// And for one that is not turned, of which upright boxes have the better edges.
const UPRIGHT_BETTER: f64 = 0.05;
/// One that is not turned, or where boxes lean, replaces them only where they are plainly wrong; none that is not
/// turned where a known light is at work.
const MUCH_BETTER: f64 = 0.1;
/// A box belongs to a patch if so much of it lies there.
const LIES_IN: f64 = 0.5;
/// So many cells around a patch are looked at: the boxes there may reach beyond it.
const AROUND_CELLS: usize = 8;
/// A contour is followed to this many cells.
const TOLERANCE_CELLS: f64 = 1.25;
/// That of what has no simpler shape may be so many times as coarse.
const COARSER: [f64; 3] = [1.0, 2.0, 4.0];
/// One that replaces boxes agrees with its patch nearly wholly if it is more than so many times as coarse.
const COARSE: f64 = 2.0;
const WHOLLY: f64 = 0.98;
/// A shape's outline encloses at most so much more than its patch has cells: a ring is no shape.
const MOST_ENCLOSED: f64 = 1.15;
/// An edge of this direction or less against the arena's is upright, radians; so much of a shape's outline
/// must be turned by more.
const UPRIGHT: f64 = 0.06;
const LEAST_TURNED: f64 = 0.4;
/// With more corners than these only so many edges may be shorter than this share of the outline; none
/// where a known light casts shadows, which leave ragged outlines.
const PLAIN_CORNERS: usize = 5;
const FEW_SHORT: usize = 5;
const SHORT_EDGE: f64 = 0.045;
/// What ends this near to the border, cells, ends at it.
const BORDER_CELLS: f64 = 2.5;

/// A shape and the boxes that it replaces.
pub(super) struct Shaped {
    pub(super) obstacle: Obstacle,
    /// The indices of the boxes.
    pub(super) replaces: Vec<usize>,
}

/// What is known where patches are held against boxes.
pub(super) struct Patches<'a> {
    pub(super) frame: PlanFrame,
    /// How far inside of the nearest edge each cell is: at least 1 inside.
    pub(super) levels: &'a Raster<f32>,
    pub(super) boxes: &'a [LeaningBox],
    pub(super) foot: Option<Point>,
    /// Whether a light is known that casts shadows.
    pub(super) is_lit: bool,
}

impl Patches<'_> {
    /// The shape that explains a patch clearly better than the boxes that were found there.
    pub(super) fn shape_of(&self, patch: &[usize]) -> Option<Shaped> {
        let window = Window::around(patch, self.levels);
        let count = window.cells.cells().iter().filter(|inside| **inside).count();
        let replaces = self.boxes_in(&window);
        let in_boxes =
            |at: Point| replaces.iter().any(|&index| self.boxes[index].spans(self.foot, at, 0.0));
        let agreement = |holds: &dyn Fn(Point) -> bool| {
            let (mut both, mut any) = (0.0, 0.0);
            for (column, row) in window.places() {
                let held = holds(self.frame.point(column as f64, row as f64));
                let seen = window.holds(column, row);
                both += f64::from(u8::from(held && seen));
                any += f64::from(u8::from(held || seen));
            }
            both / any
        };
        let explained = agreement(&in_boxes);
        // Where nothing leans and no light casts shadows what is seen is what stands there.
        let is_plain = self.foot.is_none() && !self.is_lit;
        if explained > if is_plain { PLAINLY_EXPLAINED } else { WELL_EXPLAINED } {
            return None;
        }
        let is_better = |&(coarser, ref fitted): &(f64, FittedShape)| {
            let better = agreement(&|at| fitted.shape.contains(at));
            let is_turned = turned_share(&fitted.shape) > LEAST_TURNED;
            let gain = match is_turned {
                true if is_plain => PLAINLY_BETTER,
                false if is_plain => UPRIGHT_BETTER,
                // The outline of what leans is larger than what stands there, and its edges are no sides.
                true if self.foot.is_none() => CLEARLY_BETTER,
                _ => MUCH_BETTER,
            };
            better > explained + gain
                && (coarser <= COARSE || better > WHOLLY)
                && self.encloses_little(fitted, count)
                && (is_turned || !self.is_lit)
                && !is_ragged(&fitted.shape, if self.is_lit { 0 } else { FEW_SHORT })
        };
        let fitted = |coarser| Some((coarser, self.fitted(count, &window, coarser)?));
        let fits: Vec<(f64, FittedShape)> = COARSER.into_iter().filter_map(fitted).collect();
        // Of what has no simple shape the outline still tells more than boxes that miss a third of it.
        let is_outline = |(_, fitted): &&(f64, FittedShape)| {
            explained < POORLY_EXPLAINED && !self.is_lit && self.encloses_little(fitted, count)
        };
        let (_, fitted) = fits
            .iter()
            .find(|fitted| is_better(fitted))
            .or_else(|| fits.iter().find(is_outline))?;
        Some(Shaped { obstacle: self.obstacle(fitted.clone()), replaces })
    }

    /// A shape around the cells of a patch that lie inside of its edge, if there is a simple one.
    pub(super) fn outline(&self, patch: &[usize]) -> Option<Obstacle> {
        let window = Window::around(patch, self.levels);
        let fitted = COARSER.into_iter().find_map(|coarser| {
            let fitted = self.fitted(patch.len(), &window, coarser)?;
            self.encloses_little(&fitted, patch.len()).then_some(fitted)
        })?;
        Some(self.obstacle(fitted))
    }

    /// Whether a shape encloses hardly more than the `count` cells of its patch.
    fn encloses_little(&self, fitted: &FittedShape, count: usize) -> bool {
        fitted.shape.area() * self.frame.scale.powi(2) < MOST_ENCLOSED * count as f64
    }

    fn obstacle(&self, fitted: FittedShape) -> Obstacle {
        let margin = [fitted.margin + 0.5 / self.frame.scale; 4];
        let footprint = upright(&fitted.shape).map_or(fitted.shape, Shape::Rect);
        Obstacle { footprint, margin, height: None }
    }

    /// The boxes that lie in a patch.
    fn boxes_in(&self, window: &Window) -> Vec<usize> {
        let lies_in = |index: &usize| {
            let base = self.boxes[*index].base;
            let (left, top) = self.frame.cell(Point::new(base.x0, base.y1));
            let (right, low) = self.frame.cell(Point::new(base.x1, base.y0));
            let spans = |low: f64, at: i64, high: f64| low <= at as f64 && at as f64 <= high;
            let inside = window.places().filter(|&(column, row)| {
                spans(left, column, right) && spans(top, row, low) && window.holds(column, row)
            });
            let all = (right - left) * (low - top);
            inside.count() as f64 > LIES_IN * all.max(1.0)
        };
        (0..self.boxes.len()).filter(lies_in).collect()
    }

    /// The shape of a patch's outline, of which `count` cells lie inside; `coarser` multiplies the tolerance.
    fn fitted(&self, count: usize, window: &Window, coarser: f64) -> Option<FittedShape> {
        let (width, height) = (window.cells.width(), window.cells.height());
        let values = Raster::from_fn(width, height, |x, y| {
            let (column, row) = (window.column + x as i64, window.row + y as i64);
            let value = self.levels.get(column, row).unwrap_or(0.0);
            // What belongs to another patch is not this one's outside to any degree.
            if window.holds(column, row) { value } else { value.min(0.999) }
        });
        let (regions, found) = values.map(|value| value >= 1.0).regions(true);
        let mut sizes = vec![0_usize; found + 1];
        regions.cells().iter().for_each(|&region| sizes[region as usize] += 1);
        let largest = (1..=found).max_by_key(|&region| sizes[region])?;
        // Where blur joins two patches by a bridge the outline of one is not that of the whole.
        if (sizes[largest] as f64) < 0.8 * count as f64 {
            return None;
        }
        let first = regions.cells().iter().position(|&region| region as usize == largest)?;
        let (left, top) = (window.column as f64, window.row as f64);
        let points: Vec<Point> = contour(&values, first)
            .into_iter()
            .map(|(column, row)| self.to_border(self.frame.point(left + column, top + row)))
            .collect();
        fit(&points, coarser * TOLERANCE_CELLS / self.frame.scale)
    }

    /// A point, moved onto the arena's border if it is that near.
    fn to_border(&self, point: Point) -> Point {
        let reach = BORDER_CELLS / self.frame.scale + 0.004;
        let Arena { width, height } = self.frame.arena;
        let snap = |at: f64, whole: f64| match at {
            at if at < reach => 0.0,
            at if at > whole - reach => whole,
            at => at,
        };
        Point::new(snap(point.x, width), snap(point.y, height))
    }
}

/// The part of a raster around one patch, and which of its cells are the patch's.
struct Window {
    /// The raster's column and row of its first cell.
    column: i64,
    row: i64,
    cells: Raster<bool>,
}

impl Window {
    /// The part of `levels` around a patch, with those of its cells that lie inside of its edge.
    fn around(patch: &[usize], levels: &Raster<f32>) -> Self {
        let width = levels.width();
        let bounds = around(patch, width);
        let (left, top) =
            (bounds.x0.saturating_sub(AROUND_CELLS), bounds.y0.saturating_sub(AROUND_CELLS));
        let right = (bounds.x1 + AROUND_CELLS).min(width);
        let low = (bounds.y1 + AROUND_CELLS).min(levels.height());
        let mut cells = Raster::filled(right - left, low - top, false);
        for cell in patch.iter().filter(|&&cell| levels.cells()[cell] >= 1.0) {
            cells.set((cell % width - left) as i64, (cell / width - top) as i64, true);
        }
        Self { column: left as i64, row: top as i64, cells }
    }

    /// The columns and rows of its cells in the raster.
    fn places(&self) -> impl Iterator<Item = (i64, i64)> + use<> {
        let (width, height) = (self.cells.width() as i64, self.cells.height() as i64);
        let (column, row) = (self.column, self.row);
        (row..row + height).flat_map(move |y| (column..column + width).map(move |x| (x, y)))
    }

    /// Whether the raster's cell there is of the patch.
    fn holds(&self, column: i64, row: i64) -> bool {
        self.cells.get(column - self.column, row - self.row) == Some(true)
    }
}

/// The rectangle that an upright polygon of four corners is. A thin ell has four corners and upright edges too,
/// but less than half of the area of what is around it.
fn upright(shape: &Shape) -> Option<Rect> {
    let Shape::Polygon(polygon) = shape else { return None };
    let bounds = shape.bounds();
    let is_rect = polygon.corners().len() == 4
        && turned_part(polygon) == 0.0
        && bounds.area() < MOST_ENCLOSED * shape.area();
    is_rect.then_some(bounds)
}

/// Whether a polygon has many corners and `most` short edges between them at least, as noise and shadow
/// make them.
fn is_ragged(shape: &Shape, most: usize) -> bool {
    let Shape::Polygon(polygon) = shape else { return false };
    let lengths: Vec<f64> = polygon.edges().map(|(a, b)| a.distance(b)).collect();
    let short = SHORT_EDGE * lengths.iter().sum::<f64>();
    lengths.len() > PLAIN_CORNERS && lengths.iter().filter(|&&length| length < short).count() > most
}

/// The share of a shape's outline that is turned against the arena's sides.
fn turned_share(shape: &Shape) -> f64 {
    match shape {
        Shape::Rect(_) => 0.0,
        Shape::Circle(_) => 1.0,
        Shape::Polygon(polygon) => turned_part(polygon),
    }
}

fn turned_part(polygon: &Polygon) -> f64 {
    let (mut turned, mut all) = (0.0, 0.0);
    for (a, b) in polygon.edges() {
        let length = a.distance(b);
        let (across, along) = ((b.x - a.x).abs().min((b.y - a.y).abs()), length);
        all += length;
        if across > along * UPRIGHT.sin() {
            turned += length;
        }
    }
    turned / all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thin_ell_of_four_corners_is_no_upright_rectangle() {
        let polygon = |corners: &[[f64; 2]]| {
            Shape::Polygon(Polygon::new(corners.iter().map(|&at| at.into()).collect()).unwrap())
        };
        let ell = polygon(&[[0.4, 0.0], [0.405, 0.798], [0.6, 0.8], [0.4, 0.803]]);
        assert_eq!(upright(&ell), None);
        let nearly = polygon(&[[0.4, 0.0], [0.5, 0.001], [0.5, 0.3], [0.401, 0.3]]);
        assert_eq!(upright(&nearly), Some(Rect::new(0.4, 0.0, 0.5, 0.3)));
    }
}
