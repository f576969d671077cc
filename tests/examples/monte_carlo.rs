//! Drives random arenas: `cargo run --release -p wmr-tests --example monte_carlo [MISSIONS]`, 10 000 by
//! default, half of them in each envelope, on two threads.

use wmr_tests::monte_carlo::{Envelope, Tally, run};

fn main() {
    let missions: u32 =
        std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(10_000);
    let began = std::time::Instant::now();
    let (a, b) = std::thread::scope(|scope| {
        let a = scope.spawn(|| run(Envelope::A, 0, missions / 2));
        let b = scope.spawn(|| run(Envelope::B, 1_000_000, missions / 2));
        (a.join(), b.join())
    });
    for (name, tally) in [("A", a), ("B", b)] {
        match tally {
            Ok(tally) => println!("{name}: {}", line(&tally)),
            Err(_) => eprintln!("{name}: failed"),
        }
    }
    println!("{:.0} s", began.elapsed().as_secs_f64());
}

fn line(tally: &Tally) -> String {
    let at = |share: f64| {
        let place = (share * tally.errors.len() as f64) as usize;
        tally.errors.get(place.min(tally.errors.len() - 1)).map_or(0.0, |error| error * 1e3)
    };
    format!(
        "{} missions ({} arenas without a way), {} reached, {} collisions, others {:?}; error median \
         {:.2} mm, p99 {:.2} mm, max {:.2} mm; least gap {:.1} mm",
        tally.driven,
        tally.without_way,
        tally.reached,
        tally.collided,
        tally.others,
        at(0.5),
        at(0.99),
        at(1.0),
        tally.least_gap * 1e3
    )
}
