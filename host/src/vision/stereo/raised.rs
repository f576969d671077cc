//! A box that stands on the floor, and how cameras at known places see it.

use crate::geometry::Rect;
use crate::vision::boxes::LeaningBox;
use crate::vision::camera::Viewpoint;

/// No box is taller than this share of the lower camera's height.
const TALLEST: f64 = 0.4;

/// A footprint and a height, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaisedBox {
    /// Where the box stands.
    pub base: Rect,
    /// How high its top is above the floor.
    pub height: f64,
}

impl RaisedBox {
    /// The box as the camera at `view` sees it.
    pub(crate) fn seen(self, view: Viewpoint) -> LeaningBox {
        LeaningBox { base: self.base, lean: lean(view, self.height) }
    }

    /// The box of a height whose top appears at `top` on the floor.
    pub(crate) fn under(top: Rect, view: Viewpoint, height: f64) -> Self {
        let base = LeaningBox::under(top, view.foot, lean(view, height)).base;
        Self { base, height }
    }

    /// The box of a height whose outlines in both pictures together have the bounds `bounds`.
    pub(crate) fn within(bounds: Rect, views: [Viewpoint; 2], height: f64) -> Self {
        let [a, b] = views.map(|view| LeaningBox::within(bounds, view.foot, lean(view, height)));
        let (a, b) = (a.base, b.base);
        let base = Rect::new(a.x0.max(b.x0), a.y0.max(b.y0), a.x1.min(b.x1), a.y1.min(b.y1));
        Self { base, height }
    }

    /// The same box with another height, whose top appears where this one's does.
    pub(crate) fn with_height(self, view: Viewpoint, height: f64) -> Self {
        Self::under(self.seen(view).top(view.foot), view, height)
    }
}

/// How much larger than on the floor something appears at a height: H / (H − h).
pub(crate) fn lean(view: Viewpoint, height: f64) -> f64 {
    view.height / (view.height - height.min(TALLEST * view.height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use proptest::prelude::*;

    const VIEWS: [Viewpoint; 2] = [
        Viewpoint { foot: Point::new(0.5, 0.5), height: 3.0, spread: 0.0, knows_height: true },
        Viewpoint { foot: Point::new(1.5, 0.5), height: 3.0, spread: 0.0, knows_height: true },
    ];

    #[test]
    fn a_top_half_a_metre_up_moves_by_a_fifth_of_the_way_to_the_foot() {
        let raised = RaisedBox { base: Rect::new(1.0, 0.4, 1.2, 0.6), height: 0.5 };
        let [a, b] = VIEWS.map(|view| raised.seen(view).top(view.foot));
        // H / (H − h) = 3 / 2.5 = 1.2.
        assert!((a.x0 - 1.1).abs() < 1e-12 && (a.x1 - 1.34).abs() < 1e-12, "{a:?}");
        assert!((b.x0 - 0.9).abs() < 1e-12 && (b.x1 - 1.14).abs() < 1e-12, "{b:?}");
    }

    proptest! {
        #[test]
        fn joint_bounds_and_tops_lead_back_to_the_box(
            x0 in 0.0..1.8f64, y0 in 0.0..0.8f64, w in 0.05..0.5f64, d in 0.05..0.5f64, height in 0.0..0.6f64,
        ) {
            let raised = RaisedBox { base: Rect::new(x0, y0, x0 + w, y0 + d), height };
            let [a, b] = VIEWS.map(|view| raised.seen(view).bounds(view.foot));
            let joint = Rect::new(a.x0.min(b.x0), a.y0.min(b.y0), a.x1.max(b.x1), a.y1.max(b.y1));
            for again in [RaisedBox::within(joint, VIEWS, height), raised.with_height(VIEWS[0], height)] {
                let (again, base) = (<[f64; 4]>::from(again.base), <[f64; 4]>::from(raised.base));
                prop_assert!(again.iter().zip(base).all(|(a, b)| (a - b).abs() < 1e-9), "{again:?}");
            }
        }
    }
}
