//! Prints the suite's table: `cargo run --release -p wmr-tests --example scenarios`.

fn main() {
    let began = std::time::Instant::now();
    let outcomes = wmr_tests::scenarios::run_all();
    print!("{}", wmr_tests::scenarios::table(&outcomes));
    let (real, cells) = (began.elapsed(), outcomes.iter().map(|(_, row)| row.len()).sum::<usize>());
    let simulated: f64 =
        outcomes.iter().flat_map(|(_, row)| row).map(|cell| cell.duration.as_secs_f64()).sum();
    println!("{cells} cells, {simulated:.0} s simulated in {:.1} s", real.as_secs_f64());
}
