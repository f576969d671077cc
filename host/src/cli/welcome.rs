//! `wmr` without a command: what to type first.

use super::error::CliError;
use super::output::Output;
use wmr::document::WelcomeDocument;

const TEXT: &str = "\
wmr takes a photo of an arena and drives a robot through it without touching anything.

  wmr demo                  see it happen, without a robot: pictures in wmr-out
  wmr serve                 the same on a page, step by step, with your own photo
  wmr detect PHOTO --arena 1.6x2.0          what is in a photo (size: along the floor, metres)
  wmr drive PHOTO --arena 1.6x2.0 --goal 1.4,1.75 --port sim      drive there, simulated
  wmr doctor                what is ready on this computer, and what is missing

wmr --help lists all commands, wmr COMMAND --help explains one.
";

/// Prints the first words.
pub(crate) fn run(output: Output) -> Result<(), CliError> {
    let document = WelcomeDocument {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        help: "wmr --help lists all commands".to_owned(),
    };
    output.result(&document, TEXT)
}
