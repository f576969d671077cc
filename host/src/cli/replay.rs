//! `wmr replay`: a drive that was kept, as a moving picture and plots.

use super::args::ReplayArgs;
use super::error::CliError;
use super::folder::Folder;
use super::log::Log;
use super::output::Output;
use super::run::count_of_legs;
use std::time::Duration;
use wmr::document::ReplayDocument;
use wmr::geometry::Point;
use wmr::picture::replay::{Body, Replay, replay_svg};
use wmr::plan_file::PlanFile;
use wmr::run_log::RunLog;
use wmr::scene::Obstacle;

/// How long a frame of the moving picture lasts, seconds.
const FRAME: f64 = 0.05;

/// `wmr replay`.
pub(crate) fn run(args: &ReplayArgs, output: Output) -> Result<(), CliError> {
    let log = Log::read(&args.log)?;
    let out = args.out.as_deref().unwrap_or(&args.log);
    let folder = Folder::create(out)?;
    let files = folder.replay(&log.plan, &log.run, args.speed)?;
    folder.index("A drive of wmr")?;
    let (seconds, legs) = (log.run.duration(), log.plan.legs.len());
    let ended = log.run.lines.last().map_or("", |line| line.state.as_str());
    let text = format!(
        "{seconds:.1} s of {}, last heard {ended}: {}\nopen {} in a browser\n",
        count_of_legs(legs),
        files.join(", "),
        out.join("index.html").display()
    );
    let document = ReplayDocument {
        folder: out.display().to_string(),
        files: files.iter().map(|file| (*file).to_owned()).collect(),
        duration: seconds,
        words: log.run.lines.len(),
        legs,
        last_state: ended.to_owned(),
    };
    output.result(&document, &text)
}

/// A drive along its plan, moving `speed` times as fast as it was.
pub(crate) fn moving(plan: &PlanFile, run: &RunLog, speed: f64) -> String {
    let corners = |at: &Point| [at.x, at.y];
    let body = |obstacle: &Obstacle| Body {
        corners: obstacle.footprint.outline().iter().map(corners).collect(),
        shifts: Vec::new(),
    };
    let bodies: Vec<Body> = plan.scene.obstacles.iter().map(body).collect();
    replay_svg(&Replay {
        arena: plan.scene.arena,
        radius: plan.scene.robot_radius,
        bodies: &bodies,
        way: &plan.waypoints,
        trail: &run.frames(FRAME * speed),
        frame: Duration::from_secs_f64(FRAME),
        title: &format!("{:.1} s, {:.2} m", run.duration(), plan.length),
    })
}
