//! Every history of the link with so many faults, at any moment; some minutes for three:
//!
//! ```text
//! cargo run --release -p wmr-tests --example link_states -- 3
//! ```
//! Prints what the search has covered; it fails where a mission gets stuck or a leg is lost or doubled.

use wmr_tests::model::{Begin, search};

fn main() {
    let budget = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(3);
    for begin in [Begin::Fresh, Begin::BetweenPlans] {
        println!("{begin:?}, up to {budget} faults: {:?}", search(begin, budget));
    }
}
