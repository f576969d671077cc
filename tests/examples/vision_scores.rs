//! Prints vision's score on each picture of `tests/fixtures/scenes`.
//!
//! ```text
//! cargo run --release -p wmr-tests --example vision_scores
//! ```

fn main() {
    print!("{}", wmr_tests::vision_scores::table());
}
