//! The `wmr` program: the command line and the page, a thin layer over the library and the simulator.

mod cli;
#[cfg(feature = "dashboard")]
mod dashboard;

fn main() -> std::process::ExitCode {
    cli::run()
}
