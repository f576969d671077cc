//! The controller's promises in figures, each at a size that takes seconds; the full ones are printed
//! by `cargo run --release -p wmr-tests --example figures`.

use wmr_tests::figures::{self, Size, assert_kept};

#[test]
fn ideal_wheels_end_where_they_should() {
    assert_kept(&figures::accuracy::measure(Size::Test));
}

#[test]
fn no_heading_is_singular() {
    assert_kept(&figures::headings::measure(Size::Test));
}

#[test]
fn commanded_wheels_keep_their_limits() {
    assert_kept(&figures::limits::measure(Size::Test));
}

#[test]
fn legs_take_little_longer_than_the_quickest() {
    assert_kept(&figures::time::measure(Size::Test));
}

#[test]
fn errors_of_the_floor_do_not_add_up() {
    assert_kept(&figures::error_model::measure(Size::Test));
}

#[test]
fn a_slipped_robot_comes_back() {
    assert_kept(&figures::slip::measure(Size::Test));
}

#[test]
fn a_wheel_that_stands_cuts_the_drive_and_nothing_else_does() {
    assert_kept(&figures::stall::measure(Size::Test));
}

#[test]
fn calibration_finds_what_a_base_is() {
    assert_kept(&figures::calibration::measure(Size::Test));
}

#[test]
fn calibration_finds_what_scrubbing_tyres_do() {
    assert_kept(&figures::scrub::measure(Size::Test));
}

#[test]
fn pauses_and_stops_stay_on_the_path() {
    assert_kept(&figures::pause::measure(Size::Test));
}
