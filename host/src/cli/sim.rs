//! `wmr sim`: a simulated robot for any program that speaks to a serial port or socket.

use super::args::{SimArgs, VisionArgs};
use super::endpoint::SimulatedWorld;
use super::error::{CliError, Exit};
use super::input::{self, Input, Sight};
use super::mission::{self, place};
use super::output::Output;
use super::scenario;
use super::sim_camera::{self, Outlets};
use hil_sim::base::BaseParameters;
use hil_sim::emulator::EmulatedPico;
use hil_sim::in_process::InProcess;
use hil_sim::lockstep::{self, Lockstep, Pacing};
use hil_sim::realtime;
use hil_sim::script::{FileError, Script};
use hil_sim::simulation::{Firmware, Simulation, Truth};
use hil_sim::tcp::TcpPort;
use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::time::Duration;
use wmr::document::{PhysicsDocument, SimulationDocument};
use wmr::geometry::Pose;

/// `wmr sim`.
pub(crate) fn run(args: &SimArgs, output: Output) -> Result<(), CliError> {
    mission::catch_interrupts();
    if let Some(path) = &args.scenario {
        return scenario::play(path, args, output);
    }
    let script = read_script(args)?;
    if args.camera.is_used() && args.scene.is_none() {
        let message = "a camera needs an arena to look at";
        return Err(CliError::usage(message, "add --scene SCENE"));
    }
    let world = match &args.scene {
        None => SimulatedWorld::nowhere(args.seed),
        Some(path) => match input::read(
            path,
            &VisionArgs::default(),
            Sight { radius: None, resolution: 1.0, keep_steps: false, start: None },
            output,
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
    match &args.elf {
        Some(elf) => serve(world, EmulatedPico::spawn(elf)?, script, args, output),
        None => {
            let firmware = match args.base {
                Some(base) => InProcess::new(base.parameters(), 1),
                None => InProcess::numbered(args.seed),
            };
            serve(world, firmware, script, args, output)
        }
    }
}

/// The faults of the file and those of the command line.
fn read_script(args: &SimArgs) -> Result<Script, CliError> {
    let mut script = match &args.faults {
        None => Script::default(),
        Some(path) => {
            let text = read_text(path)?;
            Script::parse(&text).map_err(|error| refused(&path.display().to_string(), &error))?
        }
    };
    script.faults.extend(short_faults("--fault", &args.fault)?.faults);
    check_camera(&script, args.camera.is_used(), "--camera-out DIR or --camera-http ADDR")?;
    Ok(script)
}

/// The faults that are given with this option.
pub(super) fn short_faults(option: &str, faults: &[String]) -> Result<Script, CliError> {
    let mut script = Script::default();
    for fault in faults {
        let one = Script::parse_short(fault).map_err(|error| {
            CliError::usage(
                format!("{option} {fault}: {error}"),
                "write it as KIND,FIELD=VALUE,...",
            )
        })?;
        script.faults.extend(one.faults);
    }
    Ok(script)
}

/// A fault of a camera where there is none would do nothing, silently.
pub(super) fn check_camera(script: &Script, has_camera: bool, add: &str) -> Result<(), CliError> {
    if has_camera || !script.needs_camera() {
        return Ok(());
    }
    let message =
        "a fault of a camera, camera-..., is asked for, but no camera looks at this robot";
    Err(CliError::usage(message, format!("add {add}, or leave the fault out")))
}

/// The text of a file.
pub(super) fn read_text(path: &Path) -> Result<String, CliError> {
    input::remember(path);
    std::fs::read_to_string(path).map_err(|error| {
        let message = format!("cannot read {}: {error}", path.display());
        CliError::new(Exit::File, "file.unreadable", message, "check the file's name")
    })
}

/// A file that is wrong in some line.
pub(super) fn refused(name: &str, error: &FileError) -> CliError {
    let message = format!("{name}: {error}");
    CliError::new(Exit::File, "file.bad", message, "correct that line; the README shows a script")
}

/// What clients open.
trait Port: Read + Write {}
impl<P: Read + Write> Port for P {}

fn serve<B: Firmware>(
    world: SimulatedWorld,
    firmware: B,
    script: Script,
    args: &SimArgs,
    output: Output,
) -> Result<(), CliError> {
    let mut port = offer(args, output)?;
    if let Some(address) = &args.lockstep {
        let seconds = lockstep(firmware, address, args, &mut port, output)?.as_secs_f64();
        let text = format!("the physics ran for {seconds:.3} s");
        return output.result(&PhysicsDocument { t: seconds }, &text);
    }
    let mut simulation = match args.base {
        None => world.with(firmware, BaseParameters::seeded(args.seed)),
        Some(preset) => {
            let base = preset.base(args.seed, world.start);
            Simulation::new(firmware, base, world.world).with_solid_shapes()
        }
    };
    simulation.run_script(script);
    let size = simulation.world().map(|world| world.size);
    let camera = size.and_then(|size| sim_camera::stream(&args.camera, size, args.seed));
    let mut outlets = Outlets::open(&args.camera, camera.as_ref(), output)?;
    if let Some(camera) = camera {
        simulation = simulation.with_camera(camera);
    }
    let mut collisions = 0;
    let mut outcome = Ok(());
    realtime::run(&mut simulation, &mut port, |simulation| {
        outcome = outlets.take(simulation).map(drop);
        let truth = simulation.truth();
        let now = truth.collision_log.map_or(0, |log| log.collisions);
        if now > collisions {
            collisions = now;
            output.say(&format!(
                "collision {now}: the robot overlaps an obstacle or the border at {}",
                true_place(&truth)
            ));
        }
        outcome.is_ok() && !mission::interrupted()
    })
    .map_err(failed)?;
    outcome?;
    report(&simulation.truth(), output)
}

fn failed(error: io::Error) -> CliError {
    CliError::new(Exit::Port, "port.failed", error, "start it again")
}

/// Runs `firmware` on the physics that connect at `address`; how far their time got.
fn lockstep<B: Firmware>(
    firmware: B,
    address: &str,
    args: &SimArgs,
    port: &mut Box<dyn Port>,
    output: Output,
) -> Result<Duration, CliError> {
    let Some(physics) = accept(address, output)? else { return Ok(Duration::ZERO) };
    let step = Duration::from_secs_f64(args.step);
    let mut base = Lockstep::new(firmware, physics, step).map_err(failed)?;
    let pacing = if args.fast { Pacing::Fast } else { Pacing::RealTime };
    lockstep::run(&mut base, port, pacing, || !mission::interrupted()).map_err(failed)?;
    Ok(base.now())
}

/// Opens what `args` ask for and says where it is.
fn offer(args: &SimArgs, output: Output) -> Result<Box<dyn Port>, CliError> {
    if let Some(address) = &args.tcp {
        let port = TcpPort::listen(address.as_str());
        let port = port.map_err(|error| cannot_offer(address, &error))?;
        let address = port.address().map_err(|error| cannot_offer(address, &error))?;
        output.say(&format!("simulated robot at tcp://{address}; Ctrl-C ends it"));
        return Ok(Box::new(port));
    }
    match &args.pty {
        Some(link) => offer_pty(link, output),
        None => Err(CliError::usage("where shall the robot be?", "add --pty LINK or --tcp ADDR")),
    }
}

#[cfg(unix)]
fn offer_pty(link: &Path, output: Output) -> Result<Box<dyn Port>, CliError> {
    let name = link.display().to_string();
    let port = hil_sim::pty::Pty::open(Some(link)).map_err(|error| cannot_offer(&name, &error))?;
    let device = port.device().display();
    output.say(&format!("simulated robot at {name} ({device}); Ctrl-C ends it"));
    Ok(Box::new(port))
}

#[cfg(not(unix))]
fn offer_pty(_: &Path, _: Output) -> Result<Box<dyn Port>, CliError> {
    Err(CliError::usage("this system has no pseudo-terminals", "use --tcp 127.0.0.1:7071"))
}

fn cannot_offer(name: &str, error: &io::Error) -> CliError {
    let message = format!("{name} cannot be offered: {error}");
    CliError::new(Exit::Port, "port.offer", message, "choose another name or address")
}

/// Waits for the physics to connect; `None` if Ctrl-C came first.
fn accept(address: &str, output: Output) -> Result<Option<TcpStream>, CliError> {
    let failed = |error: io::Error| cannot_offer(address, &error);
    let listener = TcpListener::bind(address).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    let local = listener.local_addr().map_err(failed)?;
    output.say(&format!("waiting for the physics at {local}"));
    while !mission::interrupted() {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false).map_err(failed)?;
                return Ok(Some(stream));
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                std::thread::sleep(Duration::from_millis(10));
            }
            Err(error) => return Err(failed(error)),
        }
    }
    Ok(None)
}

fn true_place(truth: &Truth) -> String {
    place(truth.pose.into())
}

fn report(truth: &Truth, output: Output) -> Result<(), CliError> {
    let pose = Pose::from(truth.pose);
    let log = truth.collision_log;
    let document = SimulationDocument {
        true_pose: pose,
        collisions: log.map(|log| log.collisions),
        min_clearance: log.map(|log| log.min_clearance),
    };
    let mut text = format!("the robot ended at {}", place(pose));
    if let Some(log) = truth.collision_log {
        text +=
            &format!("\n{}", super::drive::describe_collisions(log.collisions, log.min_clearance));
    }
    output.result(&document, &text)
}
