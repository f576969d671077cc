//! What is asked of things that are kept: drives, firmware files, a shell's completions.

use crate::cli::quantity;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct ReplayArgs {
    /// The folder of a drive, as drive --log, demo and serve write it.
    pub(crate) log: PathBuf,
    /// Write the pictures into this folder instead [default: the same].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// How many times as fast as it was.
    #[arg(long, value_parser = quantity::speed, default_value = "1", value_name = "N")]
    pub(crate) speed: f64,
}

#[derive(Debug, Args)]
pub(crate) struct FlashArgs {
    /// The firmware: pico.uf2 or pico2.uf2 (or the .elf), as firmware/build leaves them.
    pub(crate) file: PathBuf,
    /// The robot that is asked to go to its boot loader, if no board waits there: auto or a device.
    #[arg(short, long, default_value = "auto")]
    pub(crate) port: String,
    /// The boot drive, if it is not found: where RPI-RP2 or RP2350 is mounted.
    #[arg(long, value_name = "DIR")]
    pub(crate) drive: Option<PathBuf>,
    /// How long is waited for the boot drive.
    #[arg(long, value_parser = quantity::span, default_value = "30s", value_name = "DURATION")]
    pub(crate) wait: Duration,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}
