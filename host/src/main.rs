//! The `wmr` command line: a thin layer over the library and the simulator.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
