//! From the words of the command line to a result, an exit code and, if it failed, an error that helps.
//!
//! ```text
//! args ─► input ─► way ─► mission ─► output, folder
//! ```

pub(crate) mod args;
mod bug;
mod calibrate;
mod calibrate_camera;
mod check;
pub(crate) mod demo;
pub(crate) mod detect;
mod detect_pair;
mod drive;
pub(crate) mod endpoint;
pub(crate) mod error;
mod export;
pub(crate) mod folder;
pub(crate) mod input;
pub(crate) mod mission;
mod monitor;
pub(crate) mod output;
pub(crate) mod params;
mod plan;
mod ports;
mod quantity;
mod queries;
mod resume;
pub(crate) mod run;
mod scenario;
#[cfg(feature = "dashboard")]
mod serve;
mod sim;
mod stop_desk;
mod tags;
pub(crate) mod way;

use args::{CalibrateCommand, CheckCommand, Cli, Command};
use clap::Parser;
use clap::error::ErrorKind;
use error::{CliError, Exit};
use output::Output;
use std::process::ExitCode;

/// Runs the command that the process was started with.
pub(crate) fn run() -> ExitCode {
    bug::guard(json_asked(), run_command)
}

/// Whether the words ask for a document, understood or not.
fn json_asked() -> bool {
    std::env::args_os().any(|word| word == "--json")
}

fn run_command() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    let output = Output { json: cli.json, quiet: cli.quiet };
    let result = match &cli.command {
        #[cfg(feature = "dashboard")]
        Command::Demo(args) if args.page => serve::demo(args, output),
        Command::Demo(args) => demo::run(args, output),
        #[cfg(feature = "dashboard")]
        Command::Serve(args) => serve::run(args, output),
        Command::Detect(args) => detect::run(args, output),
        Command::Plan(args) => plan::run(args, output),
        Command::Drive(args) => drive::run(args, output),
        Command::Export(args) => export::run(args, output),
        Command::Tags(args) => tags::run(args, output),
        Command::Sim(args) => sim::run(args, output),
        Command::Ports => ports::list(output),
        Command::Info(args) => ports::info(args, output),
        Command::Params(args) => params::run(args, output),
        Command::Calibrate(CalibrateCommand::Base(args)) => calibrate::base(args, output),
        Command::Calibrate(CalibrateCommand::Camera(args)) => calibrate_camera::run(args, output),
        Command::Check(CheckCommand::Base(args)) => check::base(args, output),
        Command::Monitor(args) => monitor::monitor(args, output),
        Command::Stop(args) => ports::stop(args, output),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output.error(&error);
            ExitCode::from(error.exit as u8)
        }
    }
}

/// Says what is wrong with the words themselves; help and version are not wrong.
fn refuse(error: &clap::Error) -> ExitCode {
    let json = json_asked();
    if json && !matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let text = error.render().to_string();
        // The first paragraph says what is wrong, on several lines if it lists arguments.
        let lines: Vec<&str> =
            text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
        let text = lines.join(" ");
        let message = text.trim_start_matches("error: ");
        let error =
            CliError::usage(message, "wmr --help, or wmr COMMAND --help, lists what is understood");
        Output { json, quiet: true }.error(&error);
        return ExitCode::from(Exit::Usage as u8);
    }
    // A closed pipe while printing help is nobody's error.
    let _ = error.print();
    ExitCode::from(error.exit_code() as u8)
}
