//! Tags that were drawn by other code than finds them: all found, corners to a tenth of a pixel, nothing else.

mod drawn_tags;

use drawn_tags::{Canvas, DrawnTag};
use proptest::prelude::*;
use wmr::vision::{Tag, TagDictionary, find_tags};

/// A tag on a small piece of floor and what is found there.
fn seen(drawn: &DrawnTag, smear: usize, seed: u64) -> Vec<Tag> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut canvas = Canvas::floor(200, 200, &mut random);
    canvas.tag(drawn);
    if smear > 1 {
        canvas.smear(smear);
    }
    find_tags(&canvas.photo(0.8, 2.0, &mut random), &TagDictionary::usual())
}

fn worst_corner(drawn: &DrawnTag, tag: &Tag) -> f64 {
    let pairs = drawn.corners.iter().zip(&tag.corners_px);
    pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_tag_of_twenty_pixels_is_found_whichever_way_it_lies(
        family in 0..3usize, id in 0..30usize, side in 20.0..60.0f64,
        turn in 0.0..6.28f64, tilt in 0.0..1.0f64, axis in 0.0..6.28f64, seed in 0..1000u64,
    ) {
        let dictionary = TagDictionary::named(["4X4_50", "6X6_250", "36h11"][family]).unwrap();
        let lying = |side: f64| DrawnTag::tilted((dictionary, id), [99.3, 101.6], side, [turn, tilt, axis]);
        let drawn = lying(side * side / lying(side).shortest_side());
        let found = seen(&drawn, 1, seed);
        prop_assert_eq!(found.len(), 1);
        prop_assert_eq!((found[0].id, found[0].dictionary.side()), (id, dictionary.side()));
        prop_assert!(worst_corner(&drawn, &found[0]) < 0.5, "{:?} {:?}", drawn, found);
    }
}

#[test]
fn a_tag_is_read_through_three_pixels_of_motion() {
    let dictionary = TagDictionary::named("4X4_50").unwrap();
    for id in 0..20 {
        let turn = id as f64 * 0.31;
        let drawn = DrawnTag::tilted((dictionary, id), [90.0, 100.0], 20.0, [turn, 0.2, 1.0]);
        let found = seen(&drawn, 3, id as u64);
        assert_eq!(found.iter().map(|tag| tag.id).collect::<Vec<_>>(), [id]);
        // The smeared picture's own middle is within half a pixel of the drawn one.
        assert!(worst_corner(&drawn, &found[0]) < 0.7, "{found:?}");
    }
}

#[test]
fn a_floor_without_tags_shows_none() {
    let all: Vec<TagDictionary> = TagDictionary::usual();
    for seed in 0..20 {
        let mut random = fastrand::Rng::with_seed(seed);
        let photo = Canvas::floor(320, 240, &mut random).photo(0.8, 2.0, &mut random);
        assert_eq!(find_tags(&photo, &all), []);
    }
}
