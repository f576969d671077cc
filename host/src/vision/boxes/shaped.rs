//! What upright boxes explain badly is taken by its own outline: turned boxes, discs, cut card.
//!
//! All cells of one connected patch that are neither floor nor shadow are held against the boxes that were
//! found there. Where boxes and patch differ by more than blur and a simple shape agrees clearly better, that
//! shape replaces the boxes. Metres in the arena frame;
//! patches are sought in the plan view.
//!
//! Deviation: the paper's obstacles are upright rectangles alone [Alghannam, Sec. II.A].

use super::projection::LeaningBox;
use crate::geometry::{Arena, Point, Rect};
use crate::scene::Obstacle;
use crate::shape::{Polygon, Shape};
use crate::vision::appearance::FOREIGN;
use crate::vision::image::{Raster, around};
use crate::vision::outline::{FittedShape, contour, fit};
use crate::vision::plan_view::PlanFrame;

/// Boxes that share this much of their area and a patch's, joined, explain the patch.
const WELL_EXPLAINED: f64 = 0.93;
/// A shape replaces them if it shares so much more.
const CLEARLY_BETTER: f64 = 0.03;
/// The same where nothing leans and no light casts shadows.
const PLAINLY_EXPLAINED: f64 = 0.97;
const PLAINLY_BETTER: f64 = 0.01;
/// One that is not turned replaces them only where they are plainly wrong, and no known light is at work.
const MUCH_BETTER: f64 = 0.1;
/// A box belongs to a patch if so much of it lies there.
const LIES_IN: f64 = 0.5;
/// So many cells around a patch are looked at: the boxes there may reach beyond it.
const AROUND_CELLS: usize = 8;
/// A contour is followed to this many cells.
const TOLERANCE_CELLS: f64 = 1.25;
/// An edge runs where the difference to the floor is this part of the greatest within so many cells.
const HALF: f32 = 0.5;
const NEAR_CELLS: i64 = 3;
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
    /// How far from floor each cell is, standard deviations; 0 where nothing is sought.
    pub(super) distances: &'a Raster<f32>,
    pub(super) boxes: &'a [LeaningBox],
    pub(super) foot: Option<Point>,
    /// Whether a light is known that casts shadows.
    pub(super) is_lit: bool,
}

impl Patches<'_> {
    /// The shape that explains a patch clearly better than the boxes that were found there.
    pub(super) fn shape_of(&self, patch: &[usize]) -> Option<Shaped> {
        let window = Window::around(patch, self.distances);
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
        let fitted = self.fitted(patch.len(), &window)?;
        let better = agreement(&|at| fitted.shape.contains(at));
        let encloses = fitted.shape.area() * self.frame.scale.powi(2) / patch.len() as f64;
        let is_turned = turned_share(&fitted.shape) > LEAST_TURNED;
        let gain = match is_turned {
            _ if is_plain => PLAINLY_BETTER,
            true => CLEARLY_BETTER,
            false => MUCH_BETTER,
        };
        let is_taken = better > explained + gain
            && encloses < MOST_ENCLOSED
            && (is_turned || !self.is_lit)
            && !is_ragged(&fitted.shape, if self.is_lit { 0 } else { FEW_SHORT });
        let margin = [fitted.margin + 0.5 / self.frame.scale; 4];
        let footprint = upright(&fitted.shape).map_or(fitted.shape, Shape::Rect);
        let obstacle = Obstacle { footprint, margin, height: None };
        is_taken.then_some(Shaped { obstacle, replaces })
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

    /// The shape of a patch's outline; `count` is its number of cells.
    fn fitted(&self, count: usize, window: &Window) -> Option<FittedShape> {
        let (width, height) = (window.cells.width(), window.cells.height());
        let values = Raster::from_fn(width, height, |x, y| {
            let (column, row) = (window.column + x as i64, window.row + y as i64);
            let value = self.level(column, row, window);
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
        fit(&points, TOLERANCE_CELLS / self.frame.scale)
    }

    /// How far inside of the edge a cell is: at least 1 inside, below 1 outside.
    fn level(&self, column: i64, row: i64, window: &Window) -> f32 {
        let at = |x: i64, y: i64| self.distances.get(x, y).unwrap_or(0.0);
        let distance = at(column, row);
        if distance <= 0.0 {
            return 0.0;
        }
        let mut greatest = FOREIGN;
        for y in row - NEAR_CELLS..=row + NEAR_CELLS {
            for x in column - NEAR_CELLS..=column + NEAR_CELLS {
                if window.holds(x, y) {
                    greatest = greatest.max(at(x, y));
                }
            }
        }
        (distance / (HALF * greatest)).min(distance / FOREIGN)
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
    fn around(patch: &[usize], raster: &Raster<f32>) -> Self {
        let width = raster.width();
        let bounds = around(patch, width);
        let (left, top) =
            (bounds.x0.saturating_sub(AROUND_CELLS), bounds.y0.saturating_sub(AROUND_CELLS));
        let right = (bounds.x1 + AROUND_CELLS).min(width);
        let low = (bounds.y1 + AROUND_CELLS).min(raster.height());
        let mut cells = Raster::filled(right - left, low - top, false);
        for cell in patch {
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

/// The rectangle that an upright polygon of four corners is.
fn upright(shape: &Shape) -> Option<Rect> {
    let Shape::Polygon(polygon) = shape else { return None };
    let is_rect = polygon.corners().len() == 4 && turned_part(polygon) == 0.0;
    is_rect.then(|| shape.bounds())
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
