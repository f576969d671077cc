//! The words of the command line.

use super::params::{self, Change};
use super::quantity;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use wmr::geometry::Arena;
use wmr::scene::Goal;
use wmr::shape::Circle;

/// What every command understands stands below its own options.
const LAST: usize = 100;

/// From a photo of an arena to a robot that drives through it without touching anything.
///
/// Lengths are metres, angles degrees; suffixes mm, cm, m, deg and rad are understood.
#[derive(Debug, Parser)]
#[command(name = "wmr", version, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
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
    Demo(DemoArgs),
    /// Open the page: see what was recognised, correct it, plan, drive and stop.
    #[cfg(feature = "dashboard")]
    Serve(ServeArgs),
    /// Find arena, obstacles and robot in a photo.
    Detect(DetectArgs),
    /// Find the way from start to goal.
    Plan(PlanArgs),
    /// Drive a robot, real or simulated, along a plan.
    Drive(DriveArgs),
    /// Write an arena as a grid map for other programs.
    Export(ExportArgs),
    /// Tags to print: for the arena's corners, the robot and the goal.
    Tags(TagsArgs),
    /// Be a simulated robot for any program that speaks to a serial port.
    Sim(SimArgs),
    /// List the serial ports, and which of them is a robot.
    Ports,
    /// Ask the robot behind a port who it is.
    Info(PortArgs),
    /// Show a robot's numbers (lengths, limits, gains), or change them.
    Params(ParamsArgs),
    /// Find out what a robot's lengths really are, or where a camera stands.
    #[command(subcommand)]
    Calibrate(CalibrateCommand),
    /// Find out whether a robot is put together right, before its first drive.
    #[command(subcommand)]
    Check(CheckCommand),
    /// Stop the robot behind a port; it stays stopped until it is told to drive.
    Stop(PortArgs),
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Where pictures and log go.
    #[arg(long, default_value = "wmr-out", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// sim, elf:FILE, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_DEMO_PORT", default_value = "sim")]
    pub(crate) port: String,
    /// Show the same photo on the page of wmr serve instead, to plan and drive there.
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
    /// The robot: auto, sim, elf:FILE, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "sim")]
    pub(crate) port: String,
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
    /// An overhead picture of the arena, PNG or JPEG.
    pub(crate) photo: PathBuf,
    /// A second picture, by another camera: heights are then measured (needs --camera).
    #[arg(requires = "camera", conflicts_with_all = ["corners", "method"])]
    pub(crate) photo_b: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    /// Radius of the disc that covers the robot.
    #[arg(long, value_parser = quantity::distance, default_value = "0.075", value_name = "R")]
    pub(crate) radius: f64,
    /// Draw each step into this folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) steps: Option<PathBuf>,
}

/// How a photo is read.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct VisionArgs {
    /// Inner size of the arena, such as 1.6x2.0; needed for a photo.
    #[arg(long, value_parser = quantity::arena, value_name = "WxH")]
    pub(crate) arena: Option<Arena>,
    /// The floor's corners in the photo, pixels, counter-clockwise from the lower left: "x,y x,y x,y x,y".
    #[arg(long, value_parser = quantity::corners, allow_hyphen_values = true, value_name = "CORNERS")]
    pub(crate) corners: Option<[[f64; 2]; 4]>,
    /// Tags (ArUco 4x4 to 7x7, AprilTag) stand in the arena's four corners: which of their points is the corner.
    #[arg(long, value_enum, conflicts_with = "corners", value_name = "POINT")]
    pub(crate) tags: Option<TagPointName>,
    /// The tag on the robot's top, its right edge ahead.
    #[arg(long, value_name = "ID")]
    pub(crate) robot_tag: Option<usize>,
    /// A tag that lies where the robot is to go.
    #[arg(long, value_name = "ID")]
    pub(crate) goal_tag: Option<usize>,
    /// A disc in which nothing is an obstacle: x,y and radius; may be given several times.
    #[arg(long, value_parser = quantity::disc, allow_hyphen_values = true, value_name = "X,Y,R")]
    pub(crate) ignore: Vec<Circle>,
    /// A calibrated camera: JSON with model, image_size, K, k1, R and t under "main", or for two pictures
    /// under "a" and "b".
    #[arg(long, value_name = "FILE")]
    pub(crate) camera: Option<PathBuf>,
    /// How obstacles are found.
    #[arg(long, value_enum, default_value_t = MethodName::Robust)]
    pub(crate) method: MethodName,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TagPointName {
    /// The corner of the black square furthest from the arena's middle.
    Outer,
    /// Its centre.
    Centre,
    /// The corner of the black square nearest to the arena's middle.
    Inner,
}

impl From<TagPointName> for wmr::vision::TagPoint {
    fn from(name: TagPointName) -> Self {
        match name {
            TagPointName::Outer => Self::Outer,
            TagPointName::Centre => Self::Centre,
            TagPointName::Inner => Self::Inner,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Against uneven light, shadows and coloured floors.
    #[default]
    Robust,
    /// The paper's own steps.
    Paper,
}

#[derive(Debug, Args)]
pub(crate) struct PlanArgs {
    /// A photo (PNG, JPEG), a scene or plan (JSON), or a map (.map, .yaml).
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

/// Which way is looked for.
#[derive(Debug, Clone, Args)]
pub(crate) struct WayArgs {
    /// Where the robot stands: x,y or x,y,heading.
    #[arg(long, value_parser = quantity::place, allow_hyphen_values = true, value_name = "x,y[,deg]")]
    pub(crate) start: Option<Goal>,
    /// Where it is to go: x,y or x,y,heading.
    #[arg(long, value_parser = quantity::place, allow_hyphen_values = true, value_name = "x,y[,deg]")]
    pub(crate) goal: Option<Goal>,
    /// Radius of the disc that covers the robot [default: the input's, or 0.075].
    #[arg(long, value_parser = quantity::distance, value_name = "R")]
    pub(crate) radius: Option<f64>,
    /// Distance to keep beyond the radius [default: 0; drive: 10 mm where there is room].
    #[arg(long, value_parser = quantity::distance, value_name = "M")]
    pub(crate) margin: Option<f64>,
    /// How the way is looked for.
    #[arg(long, value_enum, default_value_t = PlannerName::Exact)]
    pub(crate) planner: PlannerName,
    /// What makes a way good; only the exact planner looks at anything but the length.
    #[arg(long, value_enum, default_value_t = CostName::Length)]
    pub(crate) cost: CostName,
    /// The shape by which obstacles are inflated, as large as the robot's radius and margin [default: square
    /// where every obstacle is an upright rectangle, else disc].
    #[arg(long, value_enum)]
    pub(crate) inflation: Option<InflationName>,
    /// Side of a cell of a Moving AI map.
    #[arg(long, value_parser = quantity::length, default_value = "1", value_name = "M")]
    pub(crate) resolution: f64,
    /// How the time of a leg is chosen.
    #[arg(long, value_enum, default_value_t = TimingName::Limits)]
    pub(crate) timing: TimingName,
    /// With --timing paper: how long each leg takes, seconds.
    #[arg(long, value_parser = quantity::leg_time, default_value = "9", value_name = "SECONDS")]
    pub(crate) leg_time: f64,
    /// Never drive backwards; with --timing paper it never does.
    #[arg(long)]
    pub(crate) no_reverse: bool,
}

/// As on a command line without options.
impl Default for WayArgs {
    fn default() -> Self {
        Self {
            start: None,
            goal: None,
            radius: None,
            margin: None,
            planner: PlannerName::Exact,
            cost: CostName::Length,
            inflation: None,
            resolution: 1.0,
            timing: TimingName::Limits,
            leg_time: 9.0,
            no_reverse: false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InflationName {
    /// Rectangles stay rectangles, as in the paper; other shapes are covered by rectangles first.
    Square,
    /// Corners become arcs, driven along tangents less than 0.5 mm outside (exact planner, shortest path).
    Disc,
}

impl From<InflationName> for wmr::plan::Inflation {
    fn from(name: InflationName) -> Self {
        match name {
            InflationName::Square => Self::Square,
            InflationName::Disc => Self::Disc,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlannerName {
    /// The exact shortest path among the enlarged obstacles.
    Exact,
    /// The paper's grid method: Dijkstra over areas and their entry points.
    Grid,
    /// The paper's tree of all global paths.
    Tree,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CostName {
    /// The shortest way.
    Length,
    /// The quickest way within the wheels' limits.
    Time,
    /// The way with the fewest turns.
    Turns,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TimingName {
    /// As short as the wheels' limits allow.
    Limits,
    /// Three equal intervals, as in the paper.
    Paper,
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// A photo, a scene, a plan or a map.
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    /// NAME.yaml writes a ROS map with NAME.pgm beside it, NAME.map a Moving AI map.
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
    /// A plan, a photo, a scene or a map.
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) vision: VisionArgs,
    #[command(flatten)]
    pub(crate) way: WayArgs,
    /// auto, sim, elf:FILE, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
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
}

#[derive(Debug, Args)]
pub(crate) struct SimArgs {
    /// Offer a pseudo-terminal under this name (Unix).
    #[arg(long, value_name = "LINK", conflicts_with = "tcp", required_unless_present = "tcp")]
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
}

#[derive(Debug, Args)]
pub(crate) struct PortArgs {
    /// auto, tcp://HOST:PORT or a device.
    #[arg(short, long, env = "WMR_PORT", default_value = "auto")]
    pub(crate) port: String,
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
    Base(CalibrateBaseArgs),
    /// A camera's lens, height and place, from pictures of the arena: the file for --camera.
    ///
    /// Wherever boxes lean away from the camera, detect needs to know where it stands. A border seen from
    /// straight above tells where, but not how high: measure the height of the lens above the floor and
    /// give --height, or give the focal length.
    Camera(CalibrateCameraArgs),
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateCameraArgs {
    /// Pictures of the arena, PNG or JPEG, all by the fixed camera; more of them make it surer.
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
