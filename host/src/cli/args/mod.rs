//! The words of the command line.

mod camera;
mod kept;
mod photo;
mod robot;
mod way;

pub(crate) use camera::CameraArgs;
pub(crate) use kept::{CompletionsArgs, FlashArgs, ReplayArgs};
pub(crate) use photo::{MethodName, TagPointName, VisionArgs};
pub(crate) use robot::{
    CalibrateBaseArgs, CalibrateCameraArgs, CalibrateCommand, CheckBaseArgs, CheckCommand,
    MonitorArgs, ParamsArgs, PortArgs,
};
pub(crate) use way::{CostName, PlannerName, TimingName, WayArgs};

use super::quantity;
use clap::{Args, Parser, Subcommand};
use hil_sim::presets::Preset;
use hil_sim::scenario::Moment;
use std::path::PathBuf;

/// What every command understands stands below its own options.
const LAST: usize = 100;
/// What the program can do, on one screen of 24 lines.
const HELP: &str = include_str!("help.txt");

/// What was typed.
///
/// Lengths are metres, angles degrees; suffixes mm, cm, m, deg and rad are understood.
#[derive(Debug, Parser)]
#[command(name = "wmr", version, max_term_width = 100, override_help = HELP)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Print exactly one JSON document on standard output, errors too.
    #[arg(long, global = true, display_order = LAST)]
    pub(crate) json: bool,
    /// Say nothing on standard error but errors.
    #[arg(short, long, global = true, display_order = LAST)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drive a simulated robot through a photographed arena, without any hardware.
    #[command(after_help = "Example: wmr demo")]
    Demo(DemoArgs),
    /// Open the page: see what was recognised, correct it, plan, drive and stop.
    #[cfg(feature = "dashboard")]
    #[command(after_help = "Example: wmr serve --port sim")]
    Serve(ServeArgs),
    /// Find arena, obstacles and robot in a photo.
    #[command(after_help = "Example: wmr detect photo.jpg --arena 1.6x2.0 --steps steps")]
    Detect(DetectArgs),
    /// Find the way from start to goal.
    #[command(
        after_help = "Example: wmr plan photo.jpg --arena 1.6x2.0 --goal 1.4,1.75 -o plan.json"
    )]
    Plan(PlanArgs),
    /// Drive a robot, real or simulated, along a plan.
    #[command(after_help = "Example: wmr drive plan.json --port sim --log run")]
    Drive(DriveArgs),
    /// Write an arena as a grid map, or a drive as a table, for other programs.
    #[command(after_help = "Example: wmr export run -o run.csv")]
    Export(ExportArgs),
    /// Tags to print: for the arena's corners, the robot and the goal.
    #[command(after_help = "Example: wmr tags --out tags.svg --ids 0,1,2,3,7 --size 50mm")]
    Tags(TagsArgs),
    /// Be a simulated robot for any program that speaks to a serial port.
    #[command(after_help = "Example: wmr sim --tcp 127.0.0.1:7071 --base romi")]
    Sim(SimArgs),
    /// List the serial ports, and which of them is a robot.
    #[command(after_help = "Example: wmr ports")]
    Ports,
    /// Ask the robot behind a port who it is.
    #[command(after_help = "Example: wmr info --port auto")]
    Info(PortArgs),
    /// Show a robot's numbers (lengths, limits, gains), or change them.
    #[command(after_help = "Example: wmr params track=121mm speed=0.3")]
    Params(ParamsArgs),
    /// Find out what a robot's lengths really are, or where a camera stands.
    #[command(subcommand)]
    Calibrate(CalibrateCommand),
    /// Find out whether a robot is put together right, before its first drive.
    #[command(subcommand)]
    Check(CheckCommand),
    /// Show a robot's pose, state, encoder counts and battery as they change, until Ctrl-C.
    ///
    /// In a terminal one line is kept up to date; with --json each line is one document, ten a second.
    #[command(after_help = "Example: wmr monitor --port sim --for 2s")]
    Monitor(MonitorArgs),
    /// Stop the robot behind a port; it stays stopped until it is told to drive.
    ///
    /// Also while another wmr of the same user has that port (drive, calibrate, check, monitor, serve, ...): it
    /// then stops the robot, ends with exit code 7, and is what this waits for. Elsewhere than on Unix it cannot
    /// be reached: press Ctrl-C there.
    #[command(after_help = "Example: wmr stop")]
    Stop(PortArgs),
    /// Draw a drive that was kept (drive --log), moving, and how exactly it went.
    #[command(after_help = "Example: wmr replay run")]
    Replay(ReplayArgs),
    /// Put a firmware onto a Pico, with nothing but a USB cable.
    #[command(after_help = "Example: wmr flash target/firmware/pico.uf2")]
    Flash(FlashArgs),
    /// Say what is ready on this computer, what is missing, and which settings are in effect.
    ///
    /// Settings are taken from, the first that says something: the option, a variable (--port: WMR_PORT), the
    /// nearest wmr.toml from here upwards (port = "sim"), the user's file, whose name is printed.
    #[command(after_help = "Example: wmr doctor")]
    Doctor,
    /// Print what makes a shell complete wmr's words when you press Tab.
    #[command(
        after_help = "Example: wmr completions bash > ~/.local/share/bash-completion/completions/wmr"
    )]
    Completions(CompletionsArgs),
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Where pictures and log go.
    #[arg(long, default_value = "wmr-out", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// sim, elf:FILE, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_DEMO_PORT", default_value = "sim")]
    pub(crate) port: String,
    /// Show the same mission on the page of wmr serve instead: seen and planned, to be driven from there.
    #[cfg(feature = "dashboard")]
    #[arg(long, conflicts_with = "out")]
    pub(crate) page: bool,
}

/// The page of wmr serve.
#[cfg(feature = "dashboard")]
#[derive(Debug, Args)]
pub(crate) struct ServeArgs {
    /// Where the page is served: an address of this computer; beyond 127.0.0.1 others in the network can
    /// open it with the token that is printed.
    #[arg(long, default_value = "127.0.0.1:7070", value_name = "ADDR")]
    pub(crate) addr: String,
    /// Let phones and other computers in this network open the page; the address with its token is
    /// printed, and as a QR code for a phone's camera.
    #[arg(long)]
    pub(crate) lan: bool,
    /// The robot: auto, sim, elf:FILE, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "sim")]
    pub(crate) port: String,
    /// A camera over the arena that is on from the beginning: its frames are shown, and it watches the drives. A
    /// folder that fills with pictures, http://HOST:PORT/PATH (MJPEG or single pictures), or sim for a simulated
    /// camera over a simulated robot, which the page can switch on by itself too.
    #[arg(long, value_name = "SOURCE")]
    pub(crate) watch: Option<String>,
    /// With --watch: how old a picture is by the time that its source gives, seconds.
    #[arg(long, value_parser = quantity::camera_delay, default_value = "0", requires = "watch", value_name = "SECONDS")]
    pub(crate) watch_delay: f64,
    /// Keep each drive in a folder of its own in this one: photo, plan, run and report; the page lists them.
    #[arg(long, default_value = "wmr-runs", value_name = "DIR")]
    pub(crate) log: PathBuf,
    /// Do not open the page in the browser.
    #[arg(long)]
    pub(crate) no_open: bool,
    /// With a simulated robot: how many of its seconds pass in one second.
    #[arg(long, value_parser = quantity::speed, default_value = "1", value_name = "N")]
    pub(crate) sim_speed: f64,
    /// Which of many slightly different robots is simulated.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) sim_seed: u64,
}

#[derive(Debug, Args)]
pub(crate) struct DetectArgs {
    /// An overhead picture of the arena: PNG, JPEG, WebP, BMP, TIFF or GIF.
    pub(crate) photo: PathBuf,
    /// A second picture, by another camera: heights are then measured (needs --camera).
    #[arg(conflicts_with_all = ["corners", "method", "empty"])]
    pub(crate) photo_b: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    /// Radius of the disc that covers the robot.
    #[arg(long, value_parser = quantity::distance, default_value = "0.075", value_name = "R")]
    pub(crate) radius: f64,
    /// Draw each step into this folder; of a photo that is refused, the candidates for the border.
    #[arg(long, value_name = "DIR")]
    pub(crate) steps: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct PlanArgs {
    /// A photo (PNG, JPEG, WebP, BMP, TIFF, GIF), a scene or plan (JSON), or a map (.map, .yaml).
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    #[command(flatten)]
    pub(crate) way: WayArgs,
    /// Plan all queries that the input lists, in one arena prepared once.
    #[arg(long, conflicts_with_all = ["start", "goal", "output", "steps"])]
    pub(crate) queries: bool,
    /// Write the plan to this file, for wmr drive.
    #[arg(short, long, value_name = "PLAN")]
    pub(crate) output: Option<PathBuf>,
    /// Draw each step into this folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) steps: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// A photo, a scene, a plan or a map; for a table the folder of a drive.
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    /// NAME.yaml writes a ROS map with NAME.pgm beside it, NAME.map a Moving AI map, NAME.csv a drive.
    #[arg(short, long, value_name = "NAME")]
    pub(crate) output: PathBuf,
    /// Side of a cell [default: 0.05, of a Moving AI map 1; a ROS map keeps its own].
    #[arg(long, value_parser = quantity::length, value_name = "M")]
    pub(crate) resolution: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct TagsArgs {
    /// The SVG file to write: one sheet of A4, true to scale.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// The tags' numbers.
    #[arg(long, value_delimiter = ',', default_value = "0,1,2,3,7", value_name = "ID,...")]
    pub(crate) ids: Vec<usize>,
    /// The dictionary: 4X4_50 and the like, MIP_36h12, 36h11, 25h9.
    #[arg(long, default_value = "4X4_50", value_name = "NAME")]
    pub(crate) dictionary: String,
    /// How wide the black square is.
    #[arg(long, value_parser = quantity::length, default_value = "50mm", value_name = "M")]
    pub(crate) size: f64,
}

#[derive(Debug, Args)]
pub(crate) struct DriveArgs {
    /// A plan, a photo, a scene or a map; with --watch it may be left out, as the first frame is a photo.
    #[arg(required_unless_present = "watch")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    #[command(flatten)]
    pub(crate) way: WayArgs,
    /// auto, sim, elf:FILE, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
    /// Let a camera watch the drive: a folder that fills with pictures, http://HOST:PORT/PATH (MJPEG or single
    /// pictures), or sim for a simulated camera over a simulated robot.
    #[arg(long, value_name = "SOURCE", conflicts_with_all = ["resume", "from_start"])]
    pub(crate) watch: Option<String>,
    /// With --watch: how old a picture is by the time that its source gives, seconds.
    #[arg(long, value_parser = quantity::camera_delay, default_value = "0", requires = "watch", value_name = "SECONDS")]
    pub(crate) watch_delay: f64,
    /// With --watch: how long the robot waits for a way before it gives up, seconds.
    #[arg(long, value_parser = quantity::patience, default_value = "60", requires = "watch", value_name = "SECONDS")]
    pub(crate) watch_patience: f64,
    /// Go on with the rest of the same plan, which was cut short.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Write photo, scene, plan, run and pictures into this folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) log: Option<PathBuf>,
    /// The robot was carried to the plan's start: pass over where it knows itself to stand.
    #[arg(long, conflicts_with = "resume")]
    pub(crate) from_start: bool,
    /// Which of many slightly different robots is simulated.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) sim_seed: u64,
    /// How far beside its start a robot on --port sim really stands, and how much it is turned.
    #[arg(long, value_parser = quantity::offset, value_name = "MM,DEG")]
    pub(crate) sim_start_error: Option<(f64, f64)>,
    /// One thing that goes wrong with a robot on --port sim or its camera, as in wmr sim --fault:
    /// shape,rect=[0.9,0.4,1.1,0.6],at=2; may be repeated.
    #[arg(long, value_name = "KIND,FIELD=VALUE")]
    pub(crate) sim_fault: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct SimArgs {
    /// Offer a pseudo-terminal under this name (Unix).
    #[arg(long, value_name = "LINK", conflicts_with = "tcp",
        required_unless_present_any = ["tcp", "scenario"])]
    pub(crate) pty: Option<PathBuf>,
    /// Offer a socket at this address, such as 127.0.0.1:7071.
    #[arg(long, value_name = "ADDR")]
    pub(crate) tcp: Option<String>,
    /// Run this flashed binary in an emulator instead of the robot's logic alone.
    #[arg(long, value_name = "FILE")]
    pub(crate) elf: Option<PathBuf>,
    /// Let somebody else's physics, which connect here, take the base's place.
    #[arg(long, value_name = "ADDR", conflicts_with = "scene")]
    pub(crate) lockstep: Option<String>,
    /// With --lockstep: seconds that each line lasts.
    #[arg(long, value_parser = quantity::step, default_value = "0.001", value_name = "SECONDS")]
    pub(crate) step: f64,
    /// With --lockstep: do not wait for the clock on the wall.
    #[arg(long, requires = "lockstep")]
    pub(crate) fast: bool,
    /// The arena around the robot, and where it starts; without it the floor is endless.
    #[arg(long, value_name = "SCENE")]
    pub(crate) scene: Option<PathBuf>,
    /// Which of many slightly different robots it is.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub(crate) seed: u64,
    /// Which base it drives: romi, 3pi+ or tt-kit, with mass, tyres that slip and shapes that stop it.
    #[arg(long, value_parser = quantity::preset, value_name = "NAME", conflicts_with = "lockstep")]
    pub(crate) base: Option<Preset>,
    /// What goes wrong and when, from a TOML file of [[fault]] tables.
    #[arg(long, value_name = "FILE", conflicts_with = "lockstep")]
    pub(crate) faults: Option<PathBuf>,
    /// One fault, such as loss,share=0.5,at=2,for=1 or blocked,wheel=left,event=turn,nth=2; may be repeated.
    #[arg(long, value_name = "KIND,FIELD=VALUE", conflicts_with = "lockstep")]
    pub(crate) fault: Vec<String>,
    /// Play this scenario to its end, in place of offering a robot; its end must be the expected one.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["pty", "tcp", "lockstep", "scene", "base",
        "faults", "fault"])]
    pub(crate) scenario: Option<PathBuf>,
    /// With --scenario: when its fault begins.
    #[arg(long, value_parser = quantity::moment, default_value = "drive", value_name = "MOMENT")]
    pub(crate) moment: Moment,
    /// With --scenario: draw what happened, moving, to this SVG file.
    #[arg(short, long, alias = "output", requires = "scenario", value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten, next_help_heading = "The camera over the arena")]
    pub(crate) camera: CameraArgs,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_help_fits_a_screen_and_names_every_command() {
        assert!(HELP.lines().count() <= 24 && HELP.lines().all(|line| line.len() <= 80));
        let rows = HELP.lines().filter_map(|line| line.strip_prefix("  "));
        let names = rows.filter_map(|row| row.split_once("  ")).map(|(names, _)| names);
        let mut told: Vec<&str> = names.flat_map(|names| names.split(", ")).collect();
        let command = Cli::command();
        let mut there: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        told.sort_unstable();
        there.sort_unstable();
        assert_eq!(told, there);
    }
}
