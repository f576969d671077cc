//! Where the cells of a plan view lie on the floor.
//!
//! The view reaches a margin beyond the arena, because tall boxes lean out of it. Column 0 lies at
//! x = −margin, row 0 at y = height + margin; of a part of the view they lie where the part begins.
//! Metres in the arena frame.

use crate::geometry::{Arena, Point, Rect};

/// Edges this near to a line between cells lie on it, cells.
const ON_LINE: f64 = 1e-6;

/// Where the cells of a plan view lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanFrame {
    /// The floor.
    pub arena: Arena,
    /// Cells per metre.
    pub scale: f64,
    /// How far the view reaches beyond the floor, metres.
    pub margin: f64,
    /// The column and row of the whole view at which this one begins, and how many of each it has.
    first: (usize, usize),
    count: (usize, usize),
}

impl PlanFrame {
    /// The view of a floor at `scale` cells a metre that reaches `margin` metres beyond it.
    pub fn new(arena: Arena, scale: f64, margin: f64) -> Self {
        let cells = |length: f64| ((length + 2.0 * margin) * scale).round().max(1.0) as usize;
        let count = (cells(arena.width), cells(arena.height));
        Self { arena, scale, margin, first: (0, 0), count }
    }

    /// The number of columns and rows.
    ///
    /// ```
    /// use wmr::{geometry::Arena, vision::PlanFrame};
    /// let frame = PlanFrame::new(Arena { width: 2.0, height: 1.0 }, 100.0, 0.1);
    /// assert_eq!(frame.size(), (220, 120));
    /// ```
    pub fn size(&self) -> (usize, usize) {
        self.count
    }

    /// The part of the view whose cells touch `window`, the same cells as those of the whole; one cell at least.
    ///
    /// ```
    /// use wmr::{geometry::{Arena, Point, Rect}, vision::PlanFrame};
    /// let frame = PlanFrame::new(Arena { width: 2.0, height: 1.0 }, 100.0, 0.1);
    /// let part = frame.within(Rect::new(0.5, 0.2, 0.9, 0.4));
    /// assert_eq!(part.size(), (40, 20));
    /// assert_eq!(part.point(0.0, 0.0), frame.point(60.0, 70.0));
    /// ```
    pub fn within(&self, window: Rect) -> Self {
        let (left, top) = self.cell(Point::new(window.x0, window.y1));
        let (right, low) = self.cell(Point::new(window.x1, window.y0));
        // An edge on a line between cells touches those on one side alone.
        let from = |edge: f64, count: usize| {
            ((edge + 0.5 + ON_LINE).floor().max(0.0) as usize).min(count.saturating_sub(1))
        };
        let to = |edge: f64, first: usize, count: usize| {
            ((edge + 0.5 - ON_LINE).ceil().max(0.0) as usize).clamp(first + 1, count.max(first + 1))
        };
        let (columns, rows) = self.count;
        let (x0, y0) = (from(left, columns), from(top, rows));
        let (x1, y1) = (to(right, x0, columns), to(low, y0, rows));
        let first = (self.first.0 + x0, self.first.1 + y0);
        Self { first, count: (x1 - x0, y1 - y0), ..*self }
    }

    /// The same view with every cell cut into `factor` × `factor`.
    pub(crate) fn finer(&self, factor: usize) -> Self {
        let times = |(columns, rows): (usize, usize)| (columns * factor, rows * factor);
        let scale = self.scale * factor as f64;
        Self { scale, first: times(self.first), count: times(self.count), ..*self }
    }

    /// The floor point at a column and a row, metres; whole numbers are the centres of cells.
    #[inline]
    pub fn point(&self, column: f64, row: f64) -> Point {
        let (column, row) = (column + self.first.0 as f64, row + self.first.1 as f64);
        let (x, y) = ((column + 0.5) / self.scale, (row + 0.5) / self.scale);
        Point::new(x - self.margin, self.arena.height + self.margin - y)
    }

    /// The column and row of a floor point; whole numbers are the centres of cells.
    pub fn cell(&self, point: Point) -> (f64, f64) {
        let (x, y) = (point.x + self.margin, self.arena.height + self.margin - point.y);
        let (column, row) = (x * self.scale - 0.5, y * self.scale - 0.5);
        (column - self.first.0 as f64, row - self.first.1 as f64)
    }
}
