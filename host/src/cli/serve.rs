//! `wmr serve` and `wmr demo --page`: the page.

use super::args::{DemoArgs, ServeArgs};
use super::error::CliError;
use super::output::Output;
use crate::dashboard::{self, Settings};
use std::path::PathBuf;
use std::time::Duration;

/// `wmr serve`.
pub(crate) fn run(args: &ServeArgs, output: Output) -> Result<(), CliError> {
    let settings = Settings {
        address: if args.lan { on_all_networks(&args.addr) } else { args.addr.clone() },
        port: args.port.clone(),
        speed: args.sim_speed,
        seed: args.sim_seed,
        watch: args.watch.clone(),
        watch_delay: Duration::from_secs_f64(args.watch_delay),
        log: args.log.clone(),
        open: !args.no_open,
        demo: false,
    };
    dashboard::serve(&settings, output)
}

/// The same port at every address of this computer.
fn on_all_networks(address: &str) -> String {
    let port = address.rsplit(':').next().unwrap_or(address);
    format!("0.0.0.0:{port}")
}

/// `wmr demo --page`: the demo's mission on the page, planned but not driven, at any free address.
pub(crate) fn demo(args: &DemoArgs, output: Output) -> Result<(), CliError> {
    let settings = Settings {
        address: "127.0.0.1:0".to_owned(),
        port: args.port.clone(),
        speed: 1.0,
        seed: 1,
        watch: None,
        watch_delay: Duration::ZERO,
        log: PathBuf::from("wmr-runs"),
        open: true,
        demo: true,
    };
    dashboard::serve(&settings, output)
}
