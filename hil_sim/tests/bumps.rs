//! A robot that drives against shapes: it stops or slides, and never passes.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::io;
use std::time::Duration;
use wmr_sim::base::{BaseParameters, TruePose, WheeledBase};
use wmr_sim::in_process::InProcess;
use wmr_sim::presets::Preset;
use wmr_sim::script::Script;
use wmr_sim::simulation::{Firmware, Simulation};
use wmr_sim::world::{Shape, World};

const RADIUS: f64 = 0.075;

/// Firmware that knows nothing but one duty.
struct Constant([f64; 2]);

impl Firmware for Constant {
    const STEP: Duration = Duration::from_millis(5);

    fn step(&mut self, _: &[u8], _: [i32; 2], _: &mut VecDeque<u8>) -> io::Result<[f64; 2]> {
        Ok(self.0)
    }
}

fn shapes() -> Vec<Shape> {
    let ell = [[0.9, 0.9], [1.3, 0.9], [1.3, 1.0], [1.0, 1.0], [1.0, 1.3], [0.9, 1.3]];
    let splinter = [[0.3, 1.2], [0.6, 1.203], [0.6, 1.2]];
    vec![
        Shape::Rect([0.4, 0.3, 0.7, 0.5]),
        Shape::Circle([1.2, 0.4, 0.12]),
        Shape::Polygon(ell.to_vec()),
        Shape::Polygon(splinter.to_vec()),
    ]
}

/// Every kind of base, from a place in the middle into every direction, ahead, back and in arcs.
#[test]
fn no_base_ever_passes_into_a_shape_or_wall() {
    let bases = |seed, pose| {
        let [romi, small, kit] = Preset::ALL.map(|preset| preset.base(seed, pose));
        [WheeledBase::new(BaseParameters::seeded(seed), pose), romi, small, kit]
    };
    for seed in 0..12 {
        let heading = TAU * seed as f64 / 12.0;
        let start = TruePose { x: 0.8, y: 0.7, heading };
        let duty = [[1.0, 1.0], [-1.0, -1.0], [1.0, 0.8]][seed as usize % 3];
        for base in bases(seed, start) {
            let world = World {
                size: [1.6, 1.6],
                shapes: shapes(),
                movers: Vec::new(),
                robot_radius: RADIUS,
            };
            let mut simulation =
                Simulation::new(Constant(duty), base, Some(world.clone())).with_solid_shapes();
            for _ in 0..800 {
                simulation.wait(Duration::from_millis(5)).unwrap();
                let gap = world.clearance(simulation.truth().pose);
                assert!(gap > -1e-5, "{seed} {gap}");
            }
            let log = simulation.truth().collision_log.unwrap();
            assert!(log.collisions > 0, "{seed}: it must have met something");
            // What it would have overlapped in one step of 0.5 ms at 0.7 m/s.
            assert!(log.min_clearance > -0.001, "{seed} {}", log.min_clearance);
        }
    }
}

/// Against a wall that it meets askew a base slides along, head on it stands.
#[test]
fn a_base_slides_along_a_wall_and_stands_before_it() {
    let world =
        World { size: [2.0, 2.0], shapes: Vec::new(), movers: Vec::new(), robot_radius: RADIUS };
    let run = |heading| {
        let start = TruePose { x: 1.0, y: 0.3, heading };
        let base = WheeledBase::new(BaseParameters::paper(1), start);
        let mut simulation =
            Simulation::new(Constant([0.3; 2]), base, Some(world.clone())).with_solid_shapes();
        simulation.wait(Duration::from_secs(2)).unwrap();
        simulation.truth().pose
    };
    let askew = run(-0.5);
    assert!(askew.x > 1.4 && (askew.y - RADIUS).abs() < 1e-5, "{askew:?}");
    let head_on = run(-TAU / 4.0);
    assert!((head_on.y - RADIUS).abs() < 1e-5, "{head_on:?}");
}

/// A motor too weak to spin its tyres stalls at the wall: wheels stand, and the push is its torque's.
#[test]
fn a_base_with_mass_stalls_or_spins_at_a_wall() {
    let world =
        World { size: [2.0, 2.0], shapes: Vec::new(), movers: Vec::new(), robot_radius: RADIUS };
    for (duty, stalls) in [(0.12, true), (1.0, false)] {
        let start = TruePose { x: 0.3, y: 1.0, heading: TAU / 2.0 };
        let base = WheeledBase::with_mass(Preset::Romi.design(), Preset::Romi.encoder(), start);
        let mut simulation =
            Simulation::new(Constant([duty; 2]), base, Some(world.clone())).with_solid_shapes();
        simulation.wait(Duration::from_secs(6)).unwrap();
        assert!((simulation.truth().pose.x - RADIUS).abs() < 1e-4);
        let [left, _] = simulation.base_mut().wheel_speeds();
        assert_eq!(left.abs() < 0.05, stalls, "duty {duty}: {left} rad/s");
    }
}

/// A box that drives over a resting robot pushes it on, and that is one collision.
#[test]
fn a_moving_shape_pushes_a_resting_robot_ahead_of_itself() {
    let text = "kind = \"shape\"\nrect = [0.2, 0.8, 0.4, 1.2]\nvelocity = [0.3, 0.0]\nat = 0.5";
    let script = Script::parse(&format!("[[fault]]\n{text}")).unwrap();
    let world =
        World { size: [2.0, 2.0], shapes: Vec::new(), movers: Vec::new(), robot_radius: RADIUS };
    let start = TruePose { x: 1.0, y: 1.0, heading: 1.0 };
    let base = WheeledBase::new(BaseParameters::seeded(1), start);
    let mut simulation =
        Simulation::new(InProcess::default(), base, Some(world)).with_solid_shapes();
    simulation.run_script(script);
    simulation.wait(Duration::from_secs(2)).unwrap();
    assert_eq!(simulation.truth().pose, start);
    simulation.wait(Duration::from_secs(1)).unwrap();
    // 0.3 m/s for 2.5 s: the box's right side is then at 1.15 m.
    let truth = simulation.truth();
    assert!((truth.pose.x - 1.15 - RADIUS).abs() < 0.003, "{truth:?}");
    assert_eq!(truth.collision_log.unwrap().collisions, 1);
}
