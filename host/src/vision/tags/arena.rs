//! What tags say of an arena: four in its corners where its corners are, one on the robot where it stands.
//!
//! Which tag stands in which corner is told by their places, as with a border: the origin is the corner
//! lowest at the left of the picture. Pixels in, pixels out; the floor's map makes metres of them.

use super::Tag;
use crate::geometry::{Point, Pose};
use crate::vision::camera::PlanMap;
use crate::vision::error::VisionError;

/// Which point of a corner tag the arena's corner is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TagPoint {
    /// The corner of its black ring that is furthest from the arena's middle.
    Outer,
    /// Its centre.
    Centre,
    /// The corner of its black ring that is nearest to the arena's middle.
    Inner,
}

/// The arena's corners by the four tags that stand furthest out, pixels: lower left, lower right, upper
/// right, upper left.
///
/// # Errors
/// [`VisionError::CornerTags`] with the tags that are seen if they are not four.
pub(crate) fn corners(tags: &[&Tag], point: TagPoint) -> Result<[[f64; 2]; 4], VisionError> {
    let seen = || VisionError::CornerTags { seen: tags.iter().map(|tag| tag.id).collect() };
    // With rows running down, the lower left is where y − x is greatest.
    let furthest = |across: f64, down: f64| {
        let reach = |tag: &Tag| across * tag.centre_px()[0] + down * tag.centre_px()[1];
        let most = |a: &usize, b: &usize| reach(tags[*a]).total_cmp(&reach(tags[*b]));
        (0..tags.len()).max_by(most)
    };
    let places = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, y)| furthest(x, y));
    let [Some(a), Some(b), Some(c), Some(d)] = places else { return Err(seen()) };
    let chosen = [a, b, c, d];
    let is_twice = (0..4).any(|i| chosen[..i].contains(&chosen[i]));
    if is_twice {
        return Err(seen());
    }
    let centres = chosen.map(|index| tags[index].centre_px());
    let middle = [0, 1].map(|part| centres.iter().map(|centre| centre[part]).sum::<f64>() / 4.0);
    let from_middle = |at: &[f64; 2]| (at[0] - middle[0]).hypot(at[1] - middle[1]);
    Ok(chosen.map(|index| {
        let tag = tags[index];
        let by = |a: &&[f64; 2], b: &&[f64; 2]| from_middle(a).total_cmp(&from_middle(b));
        let corner = match point {
            TagPoint::Outer => tag.corners_px.iter().max_by(by).copied(),
            TagPoint::Centre => None,
            TagPoint::Inner => tag.corners_px.iter().min_by(by).copied(),
        };
        corner.unwrap_or_else(|| tag.centre_px())
    }))
}

/// Where a tag lies on the floor's plane and which way its own x axis, from left to right, points.
pub(crate) fn pose(tag: &Tag, map: &PlanMap) -> Pose {
    let [_, upper, lower, _] = tag.corners_px.map(|corner| map.to_floor(corner));
    let position = map.to_floor(tag.centre_px());
    let ahead = Point::new((upper.x + lower.x) / 2.0, (upper.y + lower.y) / 2.0);
    let heading = (ahead.y - position.y).atan2(ahead.x - position.x);
    Pose { position, heading }
}

/// The quadrilateral on the floor that a tag covers with its white rim, one cell wide.
pub(crate) fn patch(tag: &Tag, map: &PlanMap) -> Vec<Point> {
    let side = tag.dictionary.side() as f64 + 2.0;
    let rim = 1.0 / side;
    let ends = [(-rim, -rim), (1.0 + rim, -rim), (1.0 + rim, 1.0 + rim), (-rim, 1.0 + rim)];
    let seen = ends.iter().filter_map(|&(x, y)| tag.point_px([x, y]));
    seen.map(|pixel| map.to_floor(pixel)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vision::tags::TagDictionary;

    /// A tag of 20 pixels around a place, upright.
    fn tag(id: usize, [x, y]: [f64; 2]) -> Tag {
        let corners_px = [[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]]
            .map(|[u, v]| [x + u, y + v]);
        let dictionary = TagDictionary::named("4X4_50").unwrap();
        Tag { dictionary, id, corners_px, errors: 0, explained: 1.0 }
    }

    #[test]
    fn corner_tags_are_told_by_their_places_and_their_point_as_asked() {
        let tags = [[420.0, 40.0], [40.0, 340.0], [420.0, 340.0], [40.0, 40.0]];
        let tags: Vec<Tag> = (1..).zip(tags).map(|(id, at)| tag(id, at)).collect();
        let tags: Vec<&Tag> = tags.iter().collect();
        let centres = [[40.0, 340.0], [420.0, 340.0], [420.0, 40.0], [40.0, 40.0]];
        assert_eq!(corners(&tags, TagPoint::Centre).unwrap(), centres);
        assert_eq!(corners(&tags, TagPoint::Outer).unwrap()[0], [30.0, 350.0]);
        assert_eq!(corners(&tags, TagPoint::Inner).unwrap()[2], [410.0, 50.0]);
        let error = corners(&tags[..3], TagPoint::Outer).unwrap_err();
        assert_eq!(error, VisionError::CornerTags { seen: vec![1, 2, 3] });
    }

    #[test]
    fn a_tag_points_along_its_own_x_axis() {
        let arena = crate::geometry::Arena { width: 4.0, height: 3.0 };
        let photo = crate::vision::Photo::from_rgb(400, 300, vec![[9; 3]; 120_000]).unwrap();
        let corners = [[0.0, 299.0], [399.0, 299.0], [399.0, 0.0], [0.0, 0.0]];
        let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        let mut turned = tag(5, [200.0, 150.0]);
        assert!(pose(&turned, &map).heading.abs() < 0.01);
        turned.corners_px.rotate_right(1);
        // Its top left is now where its lower left was: its x axis points up in the picture.
        let heading = pose(&turned, &map).heading;
        assert!((heading - std::f64::consts::FRAC_PI_2).abs() < 0.01, "{heading}");
        let patch = patch(&turned, &map);
        assert!((patch[0].distance(patch[1]) - 0.2 * 8.0 / 6.0).abs() < 0.01);
    }
}
