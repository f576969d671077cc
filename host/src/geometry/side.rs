//! The four sides of the arena, or of a rectangle parallel to it, and what there is one of for each.

use super::{Arena, Point};
use std::fmt;
use std::ops::{Index, IndexMut};

/// A side of the arena, as one sees it with y up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Along y = 0.
    Lower,
    /// At the greatest x.
    Right,
    /// At the greatest y.
    Upper,
    /// Along x = 0.
    Left,
}

impl Side {
    /// All four, counter-clockwise: a side runs from the corner of its number to the next.
    pub const ALL: [Self; 4] = [Self::Lower, Self::Right, Self::Upper, Self::Left];

    /// All four, in the order of a rectangle's coordinates x0, y0, x1, y1 and of margins.
    pub const EDGES: [Self; 4] = [Self::Left, Self::Lower, Self::Right, Self::Upper];

    /// The number of its coordinate among a rectangle's x0, y0, x1, y1.
    pub const fn edge(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Lower => 1,
            Self::Right => 2,
            Self::Upper => 3,
        }
    }

    /// Whether it runs along y, so that its coordinate is an x.
    pub const fn is_upright(self) -> bool {
        matches!(self, Self::Left | Self::Right)
    }

    /// Which way its coordinate changes outwards: −1 or 1.
    pub const fn outward(self) -> f64 {
        if matches!(self, Self::Left | Self::Lower) { -1.0 } else { 1.0 }
    }

    /// The side across.
    pub const fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Lower => Self::Upper,
            Self::Right => Self::Left,
            Self::Upper => Self::Lower,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Lower => "lower",
            Self::Right => "right",
            Self::Upper => "upper",
            Self::Left => "left",
        })
    }
}

/// One value for each side.
///
/// ```
/// use wmr::geometry::{PerSide, Side};
/// let names = PerSide::from_fn(|side| side.to_string());
/// assert_eq!(names[Side::Upper], "upper");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PerSide<T>([T; 4]);

impl<T> PerSide<T> {
    /// The value of each side.
    pub fn from_fn(value: impl FnMut(Side) -> T) -> Self {
        Self(Side::ALL.map(value))
    }

    /// What `change` makes of each value.
    pub fn map<U>(self, change: impl FnMut(T) -> U) -> PerSide<U> {
        PerSide(self.0.map(change))
    }

    /// Each side with its value, counter-clockwise from the lower.
    pub fn iter(&self) -> impl Iterator<Item = (Side, &T)> {
        Side::ALL.into_iter().zip(&self.0)
    }

    /// The values, counter-clockwise from the lower side's.
    pub fn values(&self) -> &[T; 4] {
        &self.0
    }
}

impl<T: Copy> PerSide<T> {
    /// The same for all sides.
    pub const fn all(value: T) -> Self {
        Self([value; 4])
    }
}

impl<T> Index<Side> for PerSide<T> {
    type Output = T;

    fn index(&self, side: Side) -> &T {
        &self.0[side as usize]
    }
}

impl<T> IndexMut<Side> for PerSide<T> {
    fn index_mut(&mut self, side: Side) -> &mut T {
        &mut self.0[side as usize]
    }
}

impl Arena {
    /// How far a point is inward from a side, metres; negative beyond it.
    pub fn inward(self, side: Side, point: Point) -> f64 {
        match side {
            Side::Lower => point.y,
            Side::Right => self.width - point.x,
            Side::Upper => self.height - point.y,
            Side::Left => point.x,
        }
    }

    /// How far a point is from the nearest side, metres; negative if it lies beyond one.
    pub fn depth(self, point: Point) -> f64 {
        Side::ALL.into_iter().map(|side| self.inward(side, point)).fold(f64::INFINITY, f64::min)
    }

    /// The side that a point lies beyond, by more than any other, and how far, metres; `None` on the arena.
    ///
    /// ```
    /// use wmr::geometry::{Arena, Point, Side};
    /// let arena = Arena { width: 2.0, height: 1.0 };
    /// assert_eq!(arena.beyond(Point::new(1.0, 0.5)), None);
    /// assert_eq!(arena.beyond(Point::new(2.25, 0.5)), Some((Side::Right, 0.25)));
    /// assert_eq!(arena.beyond(Point::new(-0.1, -0.3)), Some((Side::Lower, 0.3)));
    /// ```
    pub fn beyond(self, point: Point) -> Option<(Side, f64)> {
        let beyond = Side::ALL.map(|side| (side, -self.inward(side, point)));
        let most = beyond.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        most.filter(|(_, depth)| *depth > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    #[test]
    fn edges_are_numbered_as_a_rectangles_coordinates() {
        let rect: [f64; 4] = Rect::new(1.0, 2.0, 4.0, 8.0).into();
        for (number, side) in Side::EDGES.into_iter().enumerate() {
            assert_eq!(side.edge(), number);
            let across = rect[side.edge()] - rect[side.opposite().edge()];
            assert_eq!(across, side.outward() * if side.is_upright() { 3.0 } else { 6.0 });
        }
    }
}
