//! Where the cells of a plan view lie on the floor.
//!
//! The view reaches a margin beyond the arena, because tall boxes lean out of it. Column 0 lies at
//! x = −margin, row 0 at y = height + margin; metres in the arena frame.

use crate::geometry::{Arena, Point};

/// Where the cells of a plan view lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanFrame {
    /// The floor.
    pub arena: Arena,
    /// Cells per metre.
    pub scale: f64,
    /// How far the view reaches beyond the floor, metres.
    pub margin: f64,
}

impl PlanFrame {
    /// The number of columns and rows.
    ///
    /// ```
    /// use wmr::{geometry::Arena, vision::PlanFrame};
    /// let arena = Arena { width: 2.0, height: 1.0 };
    /// let frame = PlanFrame { arena, scale: 100.0, margin: 0.1 };
    /// assert_eq!(frame.size(), (220, 120));
    /// ```
    pub fn size(&self) -> (usize, usize) {
        let cells =
            |length: f64| ((length + 2.0 * self.margin) * self.scale).round().max(1.0) as usize;
        (cells(self.arena.width), cells(self.arena.height))
    }

    /// The floor point at a column and a row, metres; whole numbers are the centres of cells.
    #[inline]
    pub fn point(&self, column: f64, row: f64) -> Point {
        let (x, y) = ((column + 0.5) / self.scale, (row + 0.5) / self.scale);
        Point::new(x - self.margin, self.arena.height + self.margin - y)
    }

    /// The column and row of a floor point; whole numbers are the centres of cells.
    pub fn cell(&self, point: Point) -> (f64, f64) {
        let (x, y) = (point.x + self.margin, self.arena.height + self.margin - point.y);
        (x * self.scale - 0.5, y * self.scale - 0.5)
    }
}
