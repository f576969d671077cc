//! Vision must answer or refuse whatever it is given: broken files and random pictures never panic.

use proptest::prelude::*;
use wmr::geometry::Arena;
use wmr::vision::{DetectOptions, Photo, decode, detect};

const FILE: &[u8] = include_bytes!("../assets/demo.png");

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn decoding_a_damaged_file_never_panics(places in proptest::collection::vec((0usize..FILE.len(), any::<u8>()), 1..20), end in 0usize..FILE.len()) {
        let mut bytes = FILE.to_vec();
        for (place, value) in places {
            bytes[place] = value;
        }
        let _ = decode(&bytes);
        let _ = decode(&bytes[..end]);
    }

    #[test]
    fn random_bytes_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(decode(&bytes).is_err());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_picture_of_random_rectangles_is_answered_or_refused(
        rects in proptest::collection::vec((0usize..160, 0usize..120, 5usize..160, 5usize..120, any::<[u8; 3]>()), 0..12),
        noise in 0u8..40, width in 0.3..5.0f64, height in 0.3..5.0f64, given in any::<bool>(),
    ) {
        let mut state = 1u32;
        let pixels = (0..160 * 120).map(|i| {
            let (x, y) = (i % 160, i / 160);
            let inside = |r: &&(usize, usize, usize, usize, [u8; 3])| (r.0..r.0 + r.2).contains(&x) && (r.1..r.1 + r.3).contains(&y);
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let speck = if noise == 0 { 0 } else { (state >> 24) as u8 % noise };
            rects.iter().rev().find(inside).map_or([200; 3], |r| r.4).map(|code| code.saturating_sub(speck))
        });
        let photo = Photo::from_rgb(160, 120, pixels.collect()).unwrap();
        let corners = given.then_some([[10.0, 110.0], [150.0, 112.0], [148.0, 9.0], [12.0, 8.0]]);
        let options = DetectOptions { corners, ..DetectOptions::default() };
        if let Ok(seen) = detect(&photo, Arena { width, height }, &options) {
            for obstacle in seen.obstacles {
                prop_assert_eq!(obstacle.footprint.check(), Ok(()), "{:?}", obstacle);
            }
        }
    }
}
