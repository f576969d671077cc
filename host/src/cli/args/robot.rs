//! What is asked of a robot itself: its port, its numbers, its check and calibration, and the camera's.

use crate::cli::params::{self, Change};
use crate::cli::quantity;
use clap::{Args, Subcommand};
use std::path::PathBuf;
use std::time::Duration;
use wmr::geometry::Arena;

#[derive(Debug, Args)]
pub(crate) struct PortArgs {
    /// auto, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
}

#[derive(Debug, Args)]
pub(crate) struct MonitorArgs {
    /// auto, sim, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
    /// End by itself after so long, such as 10s or 2min.
    #[arg(long, value_parser = quantity::span, value_name = "DURATION")]
    pub(crate) r#for: Option<Duration>,
}

#[derive(Debug, Args)]
pub(crate) struct ParamsArgs {
    /// Numbers to change, such as track=121mm or speed=0.3; SI units where there is no suffix.
    #[arg(value_name = "NAME=VALUE", value_parser = params::change)]
    pub(crate) changes: Vec<Change>,
    /// auto, sim, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
    /// First take all numbers from this file, as --json prints them.
    #[arg(long, value_name = "FILE", conflicts_with = "defaults")]
    pub(crate) from: Option<PathBuf>,
    /// First take the defaults of a new robot.
    #[arg(long)]
    pub(crate) defaults: bool,
    /// Forget the changes when the robot loses power.
    #[arg(long)]
    pub(crate) no_save: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum CheckCommand {
    /// Turn each wheel a quarter turn, ask which one turned which way, and keep how it is wired.
    ///
    /// Put the robot on a block first: its wheels must hang free. Motors that turn backward, encoders that
    /// count backward and swapped sides need no soldering: the robot keeps in its flash how it is wired.
    #[command(after_help = "Example: wmr check base")]
    Base(CheckBaseArgs),
}

#[derive(Debug, Args)]
pub(crate) struct CheckBaseArgs {
    /// auto, sim, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
    /// Forget what was found when the robot loses power.
    #[arg(long)]
    pub(crate) no_save: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum CalibrateCommand {
    /// Wheel radius, wheel ratio and track, from courses driven and measured (UMBmark).
    #[command(after_help = "Example: wmr calibrate base --port sim")]
    Base(CalibrateBaseArgs),
    /// A camera's lens, height and place, from pictures of the arena: the file for --camera.
    ///
    /// Wherever boxes lean away from the camera, detect needs to know where it stands. A border seen from
    /// straight above tells where, but not how high: measure the height of the lens above the floor and
    /// give --height, or give the focal length.
    #[command(
        after_help = "Example: wmr calibrate camera photo.jpg --arena 1.6x2.0 --height 2.87 --out camera.json"
    )]
    Camera(CalibrateCameraArgs),
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateCameraArgs {
    /// Pictures of the arena, all by the fixed camera; more of them make it surer.
    #[arg(required = true, value_name = "PHOTO")]
    pub(crate) photos: Vec<PathBuf>,
    /// Pictures of the same arena by a second fixed camera; the file is then for detect PHOTO PHOTO_B.
    #[arg(long, num_args = 1.., value_name = "PHOTO")]
    pub(crate) second: Vec<PathBuf>,
    /// Pictures of the arena by the same camera, at the same zoom and focus, from other places, tilted by
    /// 10 to 25 degrees: they tell the focal length.
    #[arg(long, num_args = 1.., value_name = "PHOTO", conflicts_with = "second")]
    pub(crate) elsewhere: Vec<PathBuf>,
    /// Inner size of the arena, such as 1.6x2.0.
    #[arg(long, value_parser = quantity::arena, value_name = "WxH")]
    pub(crate) arena: Arena,
    /// Height of the lens above the floor, to a centimetre; of two cameras two heights: 3.08,3.1.
    #[arg(long, value_parser = quantity::height, value_delimiter = ',', value_name = "M[,M]")]
    pub(crate) height: Vec<f64>,
    /// Focal length in pixels of these pictures, to half a percent; of two cameras two.
    #[arg(long, value_parser = quantity::focal, value_delimiter = ',', value_name = "PX[,PX]")]
    pub(crate) focal: Vec<f64>,
    /// Where the floor's corners are, if they are not found: four pixels from the lower left
    /// counter-clockwise, "x,y x,y x,y x,y", to a pixel. For a second camera give it again.
    #[arg(long, value_parser = quantity::corners, allow_hyphen_values = true, value_name = "CORNERS")]
    pub(crate) corners: Vec<[[f64; 2]; 4]>,
    /// Keep this picture of the empty arena by the fixed camera beside the file: --camera then uses it.
    #[arg(long, requires = "out", conflicts_with = "second", value_name = "PHOTO")]
    pub(crate) empty: Option<PathBuf>,
    /// Write the camera to this file, for --camera.
    #[arg(short, long, alias = "output", value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateBaseArgs {
    /// auto, sim, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
    /// Side of the squares; the larger, the more exact.
    #[arg(long, value_parser = quantity::side, default_value = "1", value_name = "M")]
    pub(crate) side: f64,
    /// Forget the lengths found when the robot loses power.
    #[arg(long)]
    pub(crate) no_save: bool,
    /// With --port sim: by how many percent scale, wheel ratio and track of the simulated base differ.
    #[arg(long, value_parser = quantity::percents, allow_hyphen_values = true,
        default_value = "1,0.5,2", value_name = "P,P,P")]
    pub(crate) sim_errors: [f64; 3],
    /// Which of many slightly different robots is simulated.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) sim_seed: u64,
}
