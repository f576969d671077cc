//! `wmr demo`: the whole way at once, without any hardware.

use super::args::{DemoArgs, PlannerName, VisionArgs, WayArgs};
use super::drive::{Begin, drive_way, keep, tell};
use super::error::CliError;
use super::folder::Folder;
use super::input::{self, Input, Sight};
use super::mission::Resume;
use super::output::Output;
use super::way::{self, MarginRule};
use super::{detect, plan};
use hil_sim::script::Script;
use wmr::geometry::{Arena, Point};
use wmr::link::standing::Tolerance;
use wmr::scene::Goal;

/// A ray-traced picture of an arena with eight boxes and the robot.
pub(crate) const PHOTO: &[u8] = include_bytes!("../../assets/demo.png");
/// The inner size of that arena, metres.
pub(crate) const ARENA: Arena = Arena { width: 1.3, height: 1.55 };
/// Where the robot is to go there, metres.
const GOAL: Point = Point::new(0.996, 0.229);
/// Which of many slightly different robots drives.
const SEED: u64 = 1;

/// Where the demo's way leads, and how it is found.
pub(crate) fn way_args() -> WayArgs {
    WayArgs {
        goal: Some(Goal { position: GOAL, heading: None }),
        planner: PlannerName::Grid,
        ..WayArgs::default()
    }
}

/// Runs the demo; an error unless the goal is reached.
pub(crate) fn run(args: &DemoArgs, output: Output) -> Result<(), CliError> {
    let vision = VisionArgs { arena: Some(ARENA), ..VisionArgs::default() };
    let way_args = way_args();
    output.say(&format!("1. photo: {} × {} m arena, seen from above", ARENA.width, ARENA.height));
    let seen = input::see(
        PHOTO.to_vec(),
        &vision,
        Sight { radius: None, resolution: 1.0, keep_steps: true, start: None },
    )?;
    output.say(detect::describe(&seen).trim_end());
    let input = Input::Photo(Box::new(seen));
    output.say("2. plan: the grid method");
    let way = way::find(&input, &way_args, MarginRule::ForDriving, output)?;
    output.say(plan::describe_way(&way).trim_end());
    output.say(&format!("3. drive: robot at {}", args.port));
    let folder = Folder::begin(&args.out, &input, &way)?;
    let tolerance = Some(Tolerance::SEEN);
    let begin = Begin {
        tolerance,
        resume: Resume::Never,
        seed: SEED,
        error: None,
        script: Script::default(),
    };
    let driven = drive_way(&way, &args.port, begin, output)?;
    let outcome = tell(&driven, output);
    keep(outcome, output, || {
        folder.run(&input, &way, &driven.run)?;
        output.say(&format!("pictures and log: {}", args.out.display()));
        Ok(())
    })
}
