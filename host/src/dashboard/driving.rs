//! What moves the robot: a planned way driven and written down, and short moves from where it stands.

use super::lock;
use super::reference::{Reference, Word};
use super::robot::{RobotThread, stopped};
use crate::cli::endpoint::{SimulatedRobot, SimulatedWorld};
use crate::cli::error::{CliError, Exit};
use crate::cli::run::{Run, RunClock};
use crate::cli::way::{self, PlannedWay};
use protocol::message::State;
use protocol::motion::{Leg, Timing};
use wmr::geometry::{Point, Pose};
use wmr::legs::{LegOptions, from_wire, to_legs, to_wire};
use wmr::link::drive::{DriveError, DriveEvent, Wish, drive_as_wished};
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr::link::parameters::Request;

impl RobotThread {
    /// Drives a way by `drive`, and writes down how, with the photo that it began with.
    pub(super) fn drive_and_keep(
        &mut self,
        way: &PlannedWay,
        photo: Option<&[u8]>,
        drive: impl FnOnce(&mut Self) -> Result<(Run, Option<CliError>), CliError>,
    ) -> Result<(), CliError> {
        let (run, error) = drive(self)?;
        self.hear_rest();
        let mut report = serde_json::json!(run.document());
        if let (Some(fields), Some(error)) = (report.as_object_mut(), &error) {
            fields.insert("problem".into(), serde_json::json!(error.failure()));
        }
        let kept = self.settings.archive.keep(photo, way, &run, &report);
        let is_lost = error.as_ref().is_some_and(|error| error.exit == Exit::Link);
        self.end_run(Some(&run), error.as_ref());
        lock(&self.live).run.kept = Some(kept.map_err(|error| error.message));
        if let Some(error) = error.filter(|_| is_lost) {
            self.lose(&error);
        }
        Ok(())
    }

    /// Drives a way to its end, or to where it is cut short.
    pub(super) fn drive(
        &mut self,
        way: &PlannedWay,
        stops: u64,
    ) -> Result<(Run, Option<CliError>), CliError> {
        let file = &way.file;
        let first = file.waypoints.first().copied().unwrap_or(Point::new(0.0, 0.0));
        let start = Pose { position: first, heading: file.start_heading() };
        if self.is_simulated() || self.client.is_none() {
            // A simulated robot stands where the plan begins, as if somebody had put it there.
            let world = SimulatedWorld::new(&file.scene, start, self.settings.seed);
            self.use_robot(world, SimulatedRobot::for_timing(way.legs.timing))?;
        }
        self.greet(stops)?;
        if let Some(parameters) = self.own_parameters.filter(|_| self.is_simulated()) {
            self.ask(Request::Change(parameters))?;
        }
        let limits = self.greet(stops)?;
        let legs = file.legs_for(&way.legs, &limits);
        let mut run = Run::new(legs, limits, start);
        run.origin = way::origin(&file.scene);
        run.goal = file.waypoints.last().copied();
        let result = self.follow(&mut run, start, stops);
        if let Some(client) = &mut self.client {
            run.truth = client.port_mut().truth();
            run.link = client.statistics();
        }
        Ok((run, result.err()))
    }

    /// Follows the legs of `run` from `start`, and records how.
    pub(super) fn follow(
        &mut self,
        run: &mut Run,
        start: Pose,
        stops: u64,
    ) -> Result<(), CliError> {
        let Some(client) = &mut self.client else { return Err(stopped()) };
        let (live, controls) = (&self.live, &self.controls);
        lock(live).run.legs = run.legs.iter().map(ends).collect();
        if run.legs.is_empty() {
            return Ok(());
        }
        let mut reference = Reference::new(&run.legs, &run.limits);
        let wire_start = to_wire(start);
        let mut mission = Mission::new(run.legs.clone(), wire_start);
        let mut clock = RunClock::default();
        let deadman = self.deadman;
        let is_let_go = || deadman.is_some_and(|hold| !controls.is_held(hold));
        let wish = || match (controls.stops() != stops || is_let_go(), controls.is_paused()) {
            (true, _) => Wish::Stop,
            (false, true) => Wish::Pause,
            (false, false) => Wish::Drive,
        };
        let driven = drive_as_wished(client, &mut mission, wish, |event, _| {
            let DriveEvent::Mission(event) = event else { return };
            run.record(event, &mut clock);
            if let MissionEvent::Telemetry(telemetry) = event {
                let mut live = lock(live);
                live.hear_on_way(telemetry, run.samples.last().map(|sample| sample.time));
                if let Some(sample) = run.samples.last() {
                    let (pose, leg) = (from_wire(telemetry.pose), usize::from(telemetry.leg));
                    live.run.leg = leg;
                    let is_paused = matches!(telemetry.state, State::Paused(_));
                    let word = Word { time: sample.time, leg, pose, is_paused };
                    live.run.reference = reference.at(word);
                }
            }
        });
        driven.map(|_| ()).map_err(in_words)
    }

    /// Moves a little, from where the robot stands.
    pub(super) fn move_by(
        &mut self,
        distance: f64,
        angle: f64,
        stops: u64,
    ) -> Result<(), CliError> {
        let limits = self.greet(stops)?;
        let start = self.place().ok_or_else(stopped)?;
        let (sin, cos) = start.heading.sin_cos();
        let Point { x, y } = start.position;
        let way = [start.position, Point::new(x + distance * cos, y + distance * sin)];
        let goal_heading = (angle != 0.0).then_some(start.heading + angle);
        let options = LegOptions { timing: Timing::Limits, reverse: true };
        let legs = to_legs(&way, start.heading, goal_heading, &options, &limits);
        let mut run = Run::new(legs, limits, start);
        self.follow(&mut run, start, stops)
    }
}

/// What a page is told of a drive that ended on the way.
pub(super) fn in_words(error: DriveError) -> CliError {
    match error {
        DriveError::Stopped | DriveError::StopUnconfirmed => {
            CliError::new(Exit::Robot, "robot.stopped", error, "plan again from where it stands")
        }
        DriveError::Mission(MissionError::Stopped) => stopped(),
        error => error.into(),
    }
}

/// Where a leg begins and ends.
pub(super) fn ends(leg: &Leg) -> [Point; 2] {
    [from_wire(leg.start).position, Point::new(leg.goal.x.0.into(), leg.goal.y.0.into())]
}
