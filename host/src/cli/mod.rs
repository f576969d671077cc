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
mod doctor;
mod drive;
pub(crate) mod endpoint;
pub(crate) mod error;
mod export;
mod flash;
pub(crate) mod folder;
pub(crate) mod input;
mod log;
pub(crate) mod mission;
mod monitor;
pub(crate) mod output;
pub(crate) mod params;
mod plan;
mod port_rights;
mod ports;
mod quantity;
mod queries;
mod replay;
mod resume;
pub(crate) mod run;
mod scenario;
#[cfg(feature = "dashboard")]
mod serve;
mod settings;
mod sim;
mod sim_camera;
pub(crate) mod stop_desk;
mod tags;
pub(crate) mod watch;
pub(crate) mod way;
mod welcome;

use args::{CalibrateCommand, CheckCommand, Cli, Command, CompletionsArgs};
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};
use error::{CliError, Exit};
use output::Output;
use settings::Settings;
use std::process::ExitCode;
use wmr::document::CompletionsDocument;

/// Runs the command that the process was started with.
pub(crate) fn run() -> ExitCode {
    bug::guard(json_asked(), run_command)
}

/// Whether the words ask for a document, understood or not.
fn json_asked() -> bool {
    std::env::args_os().any(|word| word == "--json")
}

fn run_command() -> ExitCode {
    let read = Settings::read();
    // What is wrong with a file must not keep anybody from stopping a robot: that is told below.
    let settings = read.as_ref().cloned().unwrap_or_default();
    let matches = settings.apply(Cli::command()).try_get_matches();
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => return refuse(&error, &settings),
    };
    let output = Output { json: cli.json, quiet: cli.quiet };
    let result = match &cli.command {
        Some(command) => run_one(command, &read, output),
        None => read.and_then(|_| welcome::run(output)),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output.error(&error);
            ExitCode::from(error.exit as u8)
        }
    }
}

fn run_one(
    command: &Command,
    settings: &Result<Settings, CliError>,
    output: Output,
) -> Result<(), CliError> {
    match (command, settings) {
        (Command::Stop(_), Err(error)) => output.say(&format!("passed over: {}", error.message)),
        (Command::Doctor, _) | (_, Ok(_)) => (),
        (_, Err(error)) => return Err(error.clone()),
    }
    match command {
        #[cfg(feature = "dashboard")]
        Command::Demo(args) if args.page => serve::demo(args, output),
        Command::Demo(args) => demo::run(args, output),
        #[cfg(feature = "dashboard")]
        Command::Serve(args) => serve::run(args, output),
        Command::Detect(args) => detect::run(args, output),
        Command::Plan(args) => plan::run(args, output),
        Command::Drive(args) => match &args.watch {
            None => drive::run(args, output),
            Some(source) => watch::run(args, source, output),
        },
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
        Command::Replay(args) => replay::run(args, output),
        Command::Flash(args) => flash::run(args, output),
        Command::Doctor => doctor::run(settings, output),
        Command::Completions(args) => completions(args, output),
    }
}

/// `wmr completions`: words for a shell to complete.
fn completions(args: &CompletionsArgs, output: Output) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "wmr", &mut script);
    let script = String::from_utf8_lossy(&script);
    let document =
        CompletionsDocument { shell: args.shell.to_string(), script: script.into_owned() };
    output.result(&document, &document.script)
}

/// Says what is wrong with the words themselves; help and version are not wrong.
fn refuse(error: &clap::Error, settings: &Settings) -> ExitCode {
    let json = json_asked();
    if let Some(error) = settings.blamed(error) {
        Output { json, quiet: true }.error(&error);
        return ExitCode::from(error.exit as u8);
    }
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        // A closed pipe while printing help is nobody's error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    Output { json, quiet: true }.error(&misspelt(error));
    ExitCode::from(Exit::Usage as u8)
}

/// What clap says of words that are not understood, as an error of ours: its first paragraph says what is
/// wrong, on several lines if it lists arguments, and a line that begins with "tip:" what was perhaps meant.
fn misspelt(error: &clap::Error) -> CliError {
    let text = error.render().to_string();
    let lines: Vec<&str> =
        text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    let said = lines.join(" ");
    let tip = text.lines().find_map(|line| line.trim().strip_prefix("tip: "));
    let help = format!("{} --help says what is understood", asked_for());
    let help = tip.map_or(help.clone(), |tip| format!("{tip}; {help}"));
    CliError::usage(said.trim_start_matches("error: "), help)
}

/// The command that was typed, as far as it is one.
fn asked_for() -> String {
    let mut command = Cli::command();
    let mut words = "wmr".to_owned();
    let typed = std::env::args_os().skip(1).filter_map(|word| word.into_string().ok());
    for word in typed.filter(|word| !word.starts_with('-')) {
        let Some(below) = command.find_subcommand(&word).cloned() else { break };
        words = format!("{words} {word}");
        command = below;
    }
    words
}
