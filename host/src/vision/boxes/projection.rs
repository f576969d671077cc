//! A box as an overhead camera sees it: its top leans away from the camera's foot point.
//!
//! On the floor's plane the top of a box of height h appears as its footprint enlarged about the
//! camera's foot point by the lean k = H / (H − h), H the camera's height. Footprint and top are
//! axis-parallel rectangles; the sides that face the foot point lie between their edges. The outline is
//! all that the footprint sweeps on its way to the top.

use crate::geometry::{Point, Rect, Side};

/// A footprint and its lean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeaningBox {
    /// Where the box stands, metres.
    pub(crate) base: Rect,
    /// The top's size over the footprint's, at least 1.
    pub(crate) lean: f64,
}

/// A face of a box that a camera can see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Face {
    Top,
    /// A side whose normal runs along x.
    AcrossX,
    /// A side whose normal runs along y.
    AcrossY,
}

impl LeaningBox {
    /// Whether a point lies in the outline as it is seen from above `foot`, or within `slack` metres of it; in
    /// the footprint if the box does not lean.
    pub(crate) fn spans(self, foot: Option<Point>, point: Point, slack: f64) -> bool {
        let base = self.base.widened([slack; 4]);
        match foot {
            None => base.contains(point),
            Some(foot) => LeaningBox { base, ..self }.face(point, foot).is_some(),
        }
    }

    /// Where the top appears on the floor, seen from above `foot`.
    pub(crate) fn top(&self, foot: Point) -> Rect {
        enlarged(self.base, foot, self.lean)
    }

    /// The box whose top appears at `top`.
    pub(crate) fn under(top: Rect, foot: Point, lean: f64) -> Self {
        Self { base: enlarged(top, foot, 1.0 / lean), lean }
    }

    /// The box whose outline's bounds are `bounds`: near edges are the footprint's, far ones the top's.
    pub(crate) fn within(bounds: Rect, foot: Point, lean: f64) -> Self {
        let low =
            |edge: f64, foot: f64| if edge < foot { foot + (edge - foot) / lean } else { edge };
        let high =
            |edge: f64, foot: f64| if edge > foot { foot + (edge - foot) / lean } else { edge };
        let Rect { x0, y0, x1, y1 } = bounds;
        let base = Rect::new(low(x0, foot.x), low(y0, foot.y), high(x1, foot.x), high(y1, foot.y));
        Self { base, lean }
    }

    /// The bounds of the outline.
    pub(crate) fn bounds(&self, foot: Point) -> Rect {
        let (base, top) = (self.base, self.top(foot));
        Rect::new(
            base.x0.min(top.x0),
            base.y0.min(top.y0),
            base.x1.max(top.x1),
            base.y1.max(top.y1),
        )
    }

    /// Whether a side faces the camera's foot point.
    pub(crate) fn faces(&self, side: Side, foot: Point) -> bool {
        match side {
            Side::Left => self.base.x0 > foot.x,
            Side::Lower => self.base.y0 > foot.y,
            Side::Right => self.base.x1 < foot.x,
            Side::Upper => self.base.y1 < foot.y,
        }
    }

    /// Which face is seen at a floor point, if it lies in the outline.
    pub(crate) fn face(&self, point: Point, foot: Point) -> Option<Face> {
        self.face_within(self.leans_at_x(point.x, foot), self.leans_at_y(point.y, foot))
    }

    /// The least and the greatest lean with which the footprint's span in x reaches `x`.
    #[inline]
    pub(crate) fn leans_at_x(&self, x: f64, foot: Point) -> (f64, f64) {
        leans(x - foot.x, self.base.x0 - foot.x, self.base.x1 - foot.x)
    }

    /// The least and the greatest lean with which the footprint's span in y reaches `y`.
    #[inline]
    pub(crate) fn leans_at_y(&self, y: f64, foot: Point) -> (f64, f64) {
        leans(y - foot.y, self.base.y0 - foot.y, self.base.y1 - foot.y)
    }

    /// [`Self::face`] by the leans of a point's x and y, which all points of a column and a row share.
    #[inline]
    pub(crate) fn face_within(
        &self,
        (x_low, x_high): (f64, f64),
        (y_low, y_high): (f64, f64),
    ) -> Option<Face> {
        let (low, high) = (x_low.max(y_low).max(1.0), x_high.min(y_high));
        if low > high.min(self.lean) {
            None
        } else if high >= self.lean {
            Some(Face::Top)
        } else if x_high < y_high {
            Some(Face::AcrossX)
        } else {
            Some(Face::AcrossY)
        }
    }
}

fn enlarged(rect: Rect, foot: Point, factor: f64) -> Rect {
    let x = |value: f64| foot.x + factor * (value - foot.x);
    let y = |value: f64| foot.y + factor * (value - foot.y);
    Rect::new(x(rect.x0), y(rect.y0), x(rect.x1), y(rect.y1))
}

/// The factors by which the interval `low..high` may be enlarged about 0 so that it holds `value`.
#[inline]
fn leans(value: f64, low: f64, high: f64) -> (f64, f64) {
    if low > 0.0 {
        (value / high, value / low)
    } else if high < 0.0 {
        (value / low, value / high)
    } else {
        let least = if value >= 0.0 { value / high.max(1e-9) } else { value / low.min(-1e-9) };
        (least, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FOOT: Point = Point::new(1.0, 1.0);

    #[test]
    fn a_box_to_the_right_shows_its_left_side() {
        let seen = LeaningBox { base: Rect::new(2.0, 0.8, 2.4, 1.2), lean: 1.1 };
        let top = seen.top(FOOT);
        assert!((top.x0 - 2.1).abs() < 1e-12 && (top.x1 - 2.54).abs() < 1e-12);
        assert_eq!(seen.face(Point::new(2.05, 1.0), FOOT), Some(Face::AcrossX));
        assert_eq!(seen.face(Point::new(2.3, 1.0), FOOT), Some(Face::Top));
        assert_eq!(seen.face(Point::new(1.99, 1.0), FOOT), None);
        assert!(
            seen.faces(Side::Left, FOOT)
                && !seen.faces(Side::Lower, FOOT)
                && !seen.faces(Side::Right, FOOT)
        );
    }

    proptest! {
        #[test]
        fn a_point_is_in_the_outline_if_some_height_of_the_box_covers_it(
            x0 in 0.0..2.0f64, y0 in 0.0..2.0f64, w in 0.05..0.5f64, h in 0.05..0.5f64,
            lean in 1.0..1.3f64, px in 0.0..3.0f64, py in 0.0..3.0f64,
        ) {
            let seen = LeaningBox { base: Rect::new(x0, y0, x0 + w, y0 + h), lean };
            let covered = (0..=2000).any(|i| {
                let factor = 1.0 + (lean - 1.0) * f64::from(i) / 2000.0;
                let cover = enlarged(seen.base, FOOT, factor);
                px >= cover.x0 && px <= cover.x1 && py >= cover.y0 && py <= cover.y1
            });
            let inside = seen.face(Point::new(px, py), FOOT).is_some();
            // Between two of the sampled heights a corner may slip through.
            prop_assert!(inside || !covered);
            let bounds = seen.bounds(FOOT);
            prop_assert!(!inside || (px >= bounds.x0 - 1e-9 && px <= bounds.x1 + 1e-9 && py >= bounds.y0 - 1e-9 && py <= bounds.y1 + 1e-9));
        }

        #[test]
        fn top_and_bounds_lead_back_to_the_box(x0 in -1.0..2.0f64, w in 0.05..0.5f64, lean in 1.0..1.3f64) {
            let seen = LeaningBox { base: Rect::new(x0, 0.4, x0 + w, 0.7), lean };
            for again in [LeaningBox::under(seen.top(FOOT), FOOT, lean), LeaningBox::within(seen.bounds(FOOT), FOOT, lean)] {
                prop_assert!((again.base.x0 - seen.base.x0).abs() < 1e-9 && (again.base.x1 - seen.base.x1).abs() < 1e-9);
            }
        }
    }
}
