//! `wmr sim`: a simulated robot for any program that speaks to a serial port or socket.

use super::args::{SimArgs, VisionArgs};
use super::endpoint::SimulatedWorld;
use super::error::{CliError, Exit};
use super::input::{self, Input, Sight};
use super::mission::{self, place};
use super::output::Output;
use hil_sim::base::{BaseParameters, TruePose};
use hil_sim::emulator::EmulatedPico;
use hil_sim::in_process::InProcess;
use hil_sim::pty::Pty;
use hil_sim::realtime;
use hil_sim::simulation::{Brain, Simulation};
use hil_sim::tcp::TcpPort;
use host::geometry::Pose;
use serde_json::json;
use std::io::{self, Read, Write};

/// `wmr sim`.
pub(crate) fn run(args: &SimArgs, output: Output) -> Result<(), CliError> {
    mission::catch_interrupts();
    let world = match &args.scene {
        None => SimulatedWorld { world: None, start: TruePose::default(), seed: args.seed },
        Some(path) => match input::read(
            path,
            &VisionArgs::default(),
            Sight { radius: None, resolution: 1.0, keep_steps: false },
        )? {
            Input::Scene(scene) => SimulatedWorld::new(
                &scene,
                scene.start.unwrap_or(Pose::new(0.0, 0.0, 0.0)),
                args.seed,
            ),
            Input::Plan(file) => {
                let start = file.scene.start.unwrap_or(Pose::new(0.0, 0.0, 0.0));
                SimulatedWorld::new(&file.scene, start, args.seed)
            }
            Input::Photo(_) => {
                return Err(CliError::usage(
                    "a photo is no scene",
                    "make one with wmr detect PHOTO --json",
                ));
            }
        },
    };
    let base = BaseParameters::seeded(args.seed);
    match &args.elf {
        Some(elf) => serve(world.with(EmulatedPico::spawn(elf)?, base), args, output),
        None => serve(world.with(InProcess::default(), base), args, output),
    }
}

fn serve<B: Brain>(
    mut simulation: Simulation<B>,
    args: &SimArgs,
    output: Output,
) -> Result<(), CliError> {
    let failed = |name: String| {
        move |error: io::Error| {
            CliError::new(
                Exit::Port,
                "port.offer",
                format!("{name} cannot be offered: {error}"),
                "choose another name or address",
            )
        }
    };
    match (&args.pty, &args.tcp) {
        (Some(link), _) => {
            let mut port = Pty::open(Some(link)).map_err(failed(link.display().to_string()))?;
            output.say(&format!(
                "simulated robot at {} ({}); Ctrl-C ends it",
                link.display(),
                port.device().display()
            ));
            run_until_interrupted(&mut simulation, &mut port)?;
        }
        (None, Some(address)) => {
            let mut port = TcpPort::listen(address.as_str()).map_err(failed(address.clone()))?;
            let address = port.address().map_err(failed(address.clone()))?;
            output.say(&format!("simulated robot at tcp://{address}; Ctrl-C ends it"));
            run_until_interrupted(&mut simulation, &mut port)?;
        }
        (None, None) => {
            return Err(CliError::usage(
                "where shall the robot be offered?",
                "add --pty LINK or --tcp ADDR",
            ));
        }
    }
    let truth = simulation.truth();
    let pose = Pose::new(truth.pose.x, truth.pose.y, truth.pose.heading);
    let mut document = json!({"true_pose": pose});
    if let (Some(encounters), Some(fields)) = (truth.encounters, document.as_object_mut()) {
        fields.insert("collisions".into(), json!(encounters.collisions));
        fields.insert("min_clearance".into(), json!(encounters.min_clearance));
    }
    output.result(&document, &format!("the robot ended at {}", place(pose)));
    Ok(())
}

fn run_until_interrupted<B: Brain>(
    simulation: &mut Simulation<B>,
    port: &mut (impl Read + Write),
) -> Result<(), CliError> {
    realtime::run(simulation, port, |_| !mission::interrupted())
        .map_err(|error| CliError::new(Exit::Port, "port.failed", error, "start it again"))
}
