//! Vision's score on pictures with a known truth is no worse than it was; the table is printed by
//! `cargo run --release -p wmr-tests --example vision_scores`.

use wmr_tests::{figures::assert_kept, vision_scores};

#[test]
fn no_picture_scores_worse() {
    assert_kept(&vision_scores::measure());
}

#[test]
fn what_shows_no_whole_arena_is_refused() {
    vision_scores::refusals().unwrap();
}
