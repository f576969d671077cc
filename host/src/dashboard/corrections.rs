//! What a person has corrected in what was recognised: obstacles that are none, and ones that were drawn.
//!
//! ```text
//! recognised, then corrected ─► corrections ─┐
//! recognised once more ──────────────────────┴─► corrected once more
//! ```
//! A correction is the difference between two lists of obstacles, so nothing has to be marked: a scene
//! file holds its corrections by holding its obstacles. Of a later look at the same photo a person wants
//! to see the same things corrected, although their outlines may have moved a little. Metres.

use wmr::geometry::Rect;
use wmr::scene::Obstacle;
use wmr::shape::Shape;

/// Outlines that share this much of what they cover together are of one thing.
const SAME_THING: f64 = 0.4;
/// Nearer than this are the same numbers, metres: a page writes a tenth of a millimetre.
const SAME_PLACE: f64 = 1e-6;

/// The difference between what was recognised and what a person made of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Corrections {
    /// What was recognised and is no obstacle there.
    pub(super) erased: Vec<Shape>,
    /// What was drawn, moved or given another shape.
    pub(super) drawn: Vec<Obstacle>,
}

impl Corrections {
    /// What a person has changed of `recognised`; `earlier` ones stay unless they were taken back.
    pub(super) fn between(recognised: &[Obstacle], corrected: &[Obstacle], earlier: &Self) -> Self {
        let is_in = |list: &[Obstacle], shape: &Shape| {
            list.iter().any(|other| is_same_place(&other.footprint, shape))
        };
        let erased = recognised.iter().map(|obstacle| &obstacle.footprint);
        let mut erased: Vec<Shape> =
            erased.filter(|shape| !is_in(corrected, shape)).cloned().collect();
        // What this look did not show may show at the next.
        for shape in &earlier.erased {
            let shows = |list: &[Shape]| list.iter().any(|other| is_same_thing(other, shape));
            let corrected: Vec<_> = corrected.iter().map(|known| known.footprint.clone()).collect();
            if !shows(&erased) && !shows(&corrected) {
                erased.push(shape.clone());
            }
        }
        let drawn = corrected.iter().filter(|obstacle| !is_in(recognised, &obstacle.footprint));
        Self { erased, drawn: drawn.cloned().collect() }
    }

    /// `recognised`, corrected in the same way.
    pub(super) fn applied_to(&self, recognised: &[Obstacle]) -> Vec<Obstacle> {
        let is_corrected = |obstacle: &&Obstacle| {
            let drawn = self.drawn.iter().map(|drawn| &drawn.footprint);
            !self.erased.iter().chain(drawn).any(|shape| is_same_thing(shape, &obstacle.footprint))
        };
        recognised.iter().filter(is_corrected).chain(&self.drawn).cloned().collect()
    }
}

fn is_same_place(a: &Shape, b: &Shape) -> bool {
    let (a, b) = (a.outline(), b.outline());
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.distance(*b) < SAME_PLACE)
}

/// Whether two outlines are of one thing, by the upright rectangles around them.
fn is_same_thing(a: &Shape, b: &Shape) -> bool {
    let (a, b) = (a.bounds(), b.bounds());
    let width = a.x1.min(b.x1) - a.x0.max(b.x0);
    let height = a.y1.min(b.y1) - a.y0.max(b.y0);
    let shared = width.max(0.0) * height.max(0.0);
    let together = Rect::area(a) + Rect::area(b) - shared;
    shared > SAME_THING * together
}

#[cfg(test)]
mod tests {
    use super::*;
    use wmr::geometry::Point;
    use wmr::shape::Circle;

    fn boxes(rects: &[[f64; 4]]) -> Vec<Obstacle> {
        rects.iter().map(|&[x0, y0, x1, y1]| Rect::new(x0, y0, x1, y1).into()).collect()
    }

    const SEEN: [[f64; 4]; 3] = [[0.0, 0.0, 0.2, 0.2], [0.5, 0.5, 0.7, 0.7], [1.0, 0.0, 1.2, 0.4]];

    #[test]
    fn an_erased_and_a_moved_box_stay_so_when_the_outlines_move_a_little() {
        let seen = boxes(&SEEN);
        let corrected = boxes(&[SEEN[0], [1.05, 0.0, 1.25, 0.4]]);
        let corrections = Corrections::between(&seen, &corrected, &Corrections::default());
        assert_eq!(corrections.erased.len(), 2);
        assert_eq!(corrections.drawn, corrected[1..]);
        let again = boxes(&SEEN.map(|sides| sides.map(|side| side + 0.003)));
        let wanted = [again[0].clone(), corrected[1].clone()];
        assert_eq!(corrections.applied_to(&again), wanted);
    }

    #[test]
    fn what_one_look_does_not_show_is_still_erased_at_the_next() {
        let seen = boxes(&SEEN);
        let first = Corrections::between(&seen, &seen[1..], &Corrections::default());
        let without = first.applied_to(&seen[1..]);
        let second = Corrections::between(&seen[1..], &without, &first);
        assert_eq!(second.applied_to(&seen), seen[1..]);
        // Put back, it stays.
        let third = Corrections::between(&seen, &seen, &second);
        assert_eq!(third, Corrections::default());
    }

    #[test]
    fn a_box_beside_or_inside_an_erased_one_is_another() {
        let erased = Corrections::between(&boxes(&SEEN[2..]), &[], &Corrections::default());
        let others = boxes(&[[1.2, 0.0, 1.4, 0.4], [1.05, 0.05, 1.15, 0.15]]);
        assert_eq!(erased.applied_to(&others), others);
    }

    #[test]
    fn a_disc_in_the_place_of_a_box_takes_its_place() {
        let disc = Shape::Circle(Circle { centre: Point::new(0.6, 0.6), radius: 0.1 });
        let drawn = Obstacle { footprint: disc, ..boxes(&SEEN)[0].clone() };
        let mut corrected = boxes(&SEEN);
        corrected[1] = drawn.clone();
        let corrections = Corrections::between(&boxes(&SEEN), &corrected, &Corrections::default());
        let again = corrections.applied_to(&boxes(&SEEN));
        assert_eq!(again.len(), 3);
        assert_eq!(again[2], drawn);
    }
}
