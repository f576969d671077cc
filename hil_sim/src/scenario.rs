//! A scenario as a file: a world, a mission, a fault, and how it should end.
//!
//! ```toml
//! title = "the right wheel is held fast"
//!
//! [world]
//! size = [1.6, 1.2]              # m
//! radius = 0.075                 # of the robot
//! base = "romi"                  # or none: the default base
//! camera = "good"                # the robot is told where it is, 5 times a second; or "pictures": where it is seen
//! shapes = [{ rect = [0.8, 0.0, 1.0, 0.4] }]
//! movers = [{ circle = [0.2, 1.0, 0.1], velocity = [0.1, 0.0] }]   # m/s; or way = [[x, y], ...], speed
//!
//! [mission]
//! start = [0.4, 0.3, 0.0]        # x, y, heading, m and rad
//! way = [[0.8, 0.6]]             # then these points
//! goal_heading = 1.57
//!
//! [[fault]]                      # as in a script; times count from the moment that is tested
//! kind = "blocked"
//! wheel = "right"
//!
//! [expect]                       # the moment the fault begins at, and what the end is called
//! drive = "robot.stall"
//! ```

use crate::base::{BaseParameters, TruePose, WheeledBase};
use crate::camera::{self, Stream, Timing};
use crate::in_process::InProcess;
use crate::noise::normal;
use crate::presets::Preset;
use crate::script::{FileError, Script, movers, shapes};
use crate::simulation::{Firmware, Simulation};
use crate::toml_file::{Section, must_be, parse};
use crate::world::World;
use protocol::parameters::Parameters;
use std::io;
use std::time::Duration;

/// After its end a scenario is watched for twice so long.
const AFTERWARDS: Duration = Duration::from_secs(2);
/// In the second half it moves by no more, m and rad: a resting encoder flickers by a count.
const STILL: f64 = 0.001;
const STILL_HEADING: f64 = 0.01;
/// A camera's error, m and rad, one σ.
const CAMERA_ERROR: [f64; 2] = [0.002, 0.005];
/// The pictures of a scenario's camera, pixels, how many it takes in a second, and how late they come.
const PICTURE: [usize; 2] = [640, 480];
const PICTURE_RATE: f64 = 5.0;
const PICTURE_LATENCY: Duration = Duration::from_millis(100);

/// Who tells the robot of a scenario where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// Nobody.
    None,
    /// Somebody who knows, but for a small error.
    Poses,
    /// Whoever finds it in the pictures of a camera.
    Pictures,
}

/// When a fault of a scenario begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// Before anybody talks to the robot.
    Idle,
    /// In the first turn on the spot.
    FirstTurn,
    /// On the straight.
    Drive,
    /// In the turn at the goal.
    LastTurn,
    /// While it is held on its way; it goes on a second later.
    Paused,
    /// After a stop on its way; it is sent on a second later.
    Stopped,
}

impl Moment {
    /// All of them, with their names in files.
    pub const ALL: [(&'static str, Self); 6] = [
        ("idle", Self::Idle),
        ("first-turn", Self::FirstTurn),
        ("drive", Self::Drive),
        ("last-turn", Self::LastTurn),
        ("paused", Self::Paused),
        ("stopped", Self::Stopped),
    ];
}

/// A scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What it is about.
    pub title: String,
    /// Where it happens.
    pub world: World,
    /// On which base; `None` for the default one.
    pub preset: Option<Preset>,
    /// Which of many slightly different ones.
    pub seed: u64,
    /// Who tells the robot where it is.
    pub watch: Watch,
    /// Where the robot stands and believes to stand.
    pub start: TruePose,
    /// The points that it then drives to, m.
    pub way: Vec<[f64; 2]>,
    /// How it should look at the end, rad.
    pub goal_heading: Option<f64>,
    /// What goes wrong.
    pub script: Script,
    /// How it should end, for each moment that is tested.
    pub expect: Vec<(Moment, String)>,
}

impl Scenario {
    /// Reads a scenario.
    ///
    /// # Errors
    /// [`FileError`]
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let table = parse(text)?;
        let file = Section::new(text, table.get_ref(), 0);
        let needed = |name: &'static str| {
            file.section(name)?.ok_or_else(|| file.wrong(name, format!("a table: [{name}]")))
        };
        let (world, mission, expect) = (needed("world")?, needed("mission")?, needed("expect")?);
        let title = file.text("title")?.ok_or_else(|| file.wrong("title", "text in quotes"))?;
        let presets = Preset::ALL.map(|preset| (preset.name(), preset));
        let start = mission.numbers("start")?;
        let [x, y, heading] = start.ok_or_else(|| mission.wrong("start", "[x, y, heading]"))?;
        let way = mission.points("way")?.filter(|way| !way.is_empty());
        let watches =
            [("none", Watch::None), ("good", Watch::Poses), ("pictures", Watch::Pictures)];
        let watch = world.choice("camera", &watches)?.unwrap_or(Watch::None);
        let scenario = Self {
            title: title.to_owned(),
            preset: world.choice("base", &presets)?,
            seed: world.number("seed", 0.0..=1e9)?.unwrap_or(1.0) as u64,
            watch,
            world: read_world(&world)?,
            start: TruePose { x, y, heading },
            way: way.ok_or_else(|| mission.wrong("way", "points: [[x, y], ...]"))?,
            goal_heading: mission.number("goal_heading", -10.0..=10.0)?,
            script: read_script(&file, watch)?,
            expect: read_expectations(&expect)?,
        };
        [&file, &world, &mission, &expect].into_iter().try_for_each(Section::finish)?;
        Ok(scenario)
    }

    /// What a careful person has told the robot of itself.
    pub fn parameters(&self) -> Parameters {
        self.preset.map_or_else(Parameters::default, Preset::parameters)
    }

    /// The scenario's robot, its logic in this process; the script does not run yet.
    pub fn in_process(&self) -> Simulation<InProcess> {
        self.with(InProcess::new(self.parameters(), 1))
    }

    /// The same with other firmware.
    pub fn with<B: Firmware>(&self, firmware: B) -> Simulation<B> {
        let base = match self.preset {
            Some(preset) => preset.base(self.seed, self.start),
            None => WheeledBase::new(BaseParameters::seeded(self.seed), self.start),
        };
        let simulation =
            Simulation::new(firmware, base, Some(self.world.clone())).with_solid_shapes();
        match self.pictures() {
            Some(camera) => simulation.with_camera(camera),
            None => simulation,
        }
    }

    /// The camera whose pictures are looked at, if there is one.
    pub fn pictures(&self) -> Option<Stream> {
        let camera = || camera::Camera::above(self.world.size, PICTURE);
        let (rate, latency, seed) = (PICTURE_RATE, PICTURE_LATENCY, self.seed);
        let timing = Timing { rate, latency, lost: 0.0, seed };
        (self.watch == Watch::Pictures).then(|| Stream::new(camera(), timing))
    }
}

/// Watches the robot of a scenario that has ended: whether it still moves two seconds later.
///
/// # Errors
/// If the firmware cannot be run any further.
pub fn still_moves<B: Firmware>(simulation: &mut Simulation<B>) -> io::Result<bool> {
    simulation.wait(AFTERWARDS)?;
    let before = simulation.truth().pose;
    simulation.wait(AFTERWARDS)?;
    let after = simulation.truth().pose;
    let way = (after.x - before.x).hypot(after.y - before.y);
    Ok(way > STILL || (after.heading - before.heading).sin().abs() > STILL_HEADING)
}

/// Somebody who knows where the robot of a scenario is, but for a small error.
#[derive(Clone, Debug)]
pub struct Camera {
    looks: bool,
    random: fastrand::Rng,
}

impl Camera {
    /// The scenario's, with errors of its seed.
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            looks: scenario.watch == Watch::Poses,
            random: fastrand::Rng::with_seed(scenario.seed),
        }
    }

    /// Where it sees a robot that is at `pose`: x, y, heading; `None` if the scenario has nobody who knows.
    pub fn sees(&mut self, pose: TruePose) -> Option<[f64; 3]> {
        let mut error = |sigma: f64| sigma * normal(&mut self.random);
        let [position, heading] = CAMERA_ERROR;
        let seen =
            [pose.x + error(position), pose.y + error(position), pose.heading + error(heading)];
        self.looks.then_some(seen)
    }
}

fn read_world(section: &Section<'_>) -> Result<World, FileError> {
    let size = section.numbers("size")?.filter(|size| size.iter().all(|side| *side > 0.0));
    Ok(World {
        size: size.ok_or_else(|| section.wrong("size", "must be [width, height] above 0"))?,
        shapes: shapes(section, "shapes")?,
        movers: movers(section, "movers")?,
        robot_radius: section.needed("radius", 0.01..=1.0)?,
    })
}

/// The faults; those of a camera need one that takes pictures.
fn read_script(file: &Section<'_>, watch: Watch) -> Result<Script, FileError> {
    let script = Script::read(file)?;
    if script.needs_camera() && watch != Watch::Pictures {
        return Err(
            file.wrong("fault", "a camera-... fault needs camera = \"pictures\" in [world]")
        );
    }
    Ok(script)
}

fn read_expectations(section: &Section<'_>) -> Result<Vec<(Moment, String)>, FileError> {
    let mut expectations = Vec::new();
    for (name, moment) in Moment::ALL {
        let text = section.text(name)?;
        expectations.extend(text.map(|text| (moment, text.to_owned())));
    }
    if expectations.is_empty() {
        return Err(section.wrong("drive", must_be(&[("reached", ()), ("robot.fault", ())])));
    }
    Ok(expectations)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "title = \"t\"\n[world]\nsize = [2, 1]\nradius = 0.075\nbase = \"romi\"\n\
        shapes = [{ circle = [1, 0.5, 0.1] }]\n[mission]\nstart = [0.3, 0.3, 0]\n\
        way = [[0.6, 0.3]]\n[[fault]]\nkind = \"reset\"\n[expect]\ndrive = \"link.restarted\"\n";

    #[test]
    fn a_scenario_is_read() {
        let scenario = Scenario::parse(TEXT).unwrap();
        assert_eq!((scenario.preset, scenario.world.shapes.len()), (Some(Preset::Romi), 1));
        assert_eq!(scenario.expect, [(Moment::Drive, "link.restarted".to_owned())]);
        assert_eq!(scenario.in_process().truth().pose, scenario.start);
    }

    #[test]
    fn a_camera_that_takes_pictures_can_be_dark() {
        let text = TEXT.replace("\"romi\"", "\"romi\"\ncamera = \"pictures\"");
        let scenario = Scenario::parse(&text.replace("\"reset\"", "\"camera-dark\"")).unwrap();
        let mut simulation = scenario.in_process();
        let brightest = |simulation: &mut Simulation<InProcess>| {
            simulation.wait(Duration::from_millis(400)).unwrap();
            std::iter::from_fn(|| simulation.take_frame()).last().unwrap().rgb.into_iter().max()
        };
        assert!(brightest(&mut simulation) > Some(150));
        simulation.run_script(scenario.script.clone());
        simulation.wait(Duration::from_millis(200)).unwrap();
        assert!(brightest(&mut simulation) < Some(60));
    }

    #[test]
    fn what_is_wrong_is_refused_with_its_line() {
        for (good, bad, message) in [
            ("\"romi\"", "\"roomba\"", "line 5: base = \"roomba\" must be \"romi\", "),
            ("[2, 1]", "[2, 0]", "line 3: size = [2, 0] must be [width, height] above 0"),
            ("way = [[0.6, 0.3]]", "way = []", "line 9: way = [] points"),
            ("drive =", "driving =", "line 12: drive is missing"),
            ("0.1] }", "0.1], z = 1 }", "line 6: there is no z here; there are circle, rect"),
            ("title", "name", "line 1: title is missing"),
            ("\"reset\"", "\"camera-dark\"", "line 10: fault "),
        ] {
            assert!(TEXT.contains(good));
            let error = Scenario::parse(&TEXT.replace(good, bad)).unwrap_err().to_string();
            assert!(error.starts_with(message), "{bad}: {error}");
        }
    }
}
