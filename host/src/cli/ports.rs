//! `wmr ports`, `wmr info` and `wmr stop`: what is there, who it is, and stop.

use super::args::PortArgs;
use super::endpoint::{self, Endpoint, SimulatedRobot, SimulatedWorld};
use super::error::CliError;
use super::output::Output;
use super::run;
use super::{mission, stop_desk};
use wmr::document::{
    LimitsDocument, PortDocument, PortsDocument, RobotDocument, StopDocument, shortest,
};
use wmr::legs;
use wmr::link::drive::DriveError;
use wmr::link::{self, LinkClient, port};

/// `wmr ports`.
pub(crate) fn list(output: Output) -> Result<(), CliError> {
    let ports = port::list()?;
    let mut text = String::new();
    for info in &ports {
        let kind = if port::is_robot(info) { "a wmr robot" } else { "something else" };
        text += &format!("{}  {kind}\n", info.port_name);
    }
    if ports.is_empty() {
        text += "no serial ports; without a robot, use --port sim\n";
    }
    output.result(&PortsDocument { ports: ports.iter().map(port_document).collect() }, &text)
}

fn port_document(info: &serialport::SerialPortInfo) -> PortDocument {
    let usb = match &info.port_type {
        serialport::SerialPortType::UsbPort(usb) => Some(usb),
        _ => None,
    };
    PortDocument {
        name: info.port_name.clone(),
        robot: port::is_robot(info),
        vid: usb.map(|usb| usb.vid),
        pid: usb.map(|usb| usb.pid),
        product: usb.and_then(|usb| usb.product.clone()),
        serial: usb.and_then(|usb| usb.serial_number.clone()),
    }
}

/// `wmr info`.
pub(crate) fn info(args: &PortArgs, output: Output) -> Result<(), CliError> {
    mission::with_robot(&args.port, |client| show(client, output))
}

fn show(client: &mut LinkClient<Box<dyn Endpoint>>, output: Output) -> Result<(), CliError> {
    let robot = mission::connect(client)?;
    let ([major, minor, patch], limits) = (robot.firmware, robot.limits);
    let document = RobotDocument {
        board: format!("{:?}", robot.board),
        firmware: format!("{major}.{minor}.{patch}"),
        protocol: robot.version,
        reset: robot.reset,
        limits: LimitsDocument {
            speed: shortest(limits.speed.0),
            acceleration: shortest(limits.acceleration.0),
            track: shortest(limits.track.0),
        },
        max_legs: robot.max_legs,
    };
    let text = format!(
        "{}, protocol {}, {} legs a plan; started because {}",
        mission::describe_robot(&robot),
        robot.version,
        robot.max_legs,
        robot.reset.explanation()
    );
    output.result(&document, &text)
}

/// `wmr stop`.
pub(crate) fn stop(args: &PortArgs, output: Output) -> Result<(), CliError> {
    mission::catch_interrupts();
    // Whoever has its port is asked first.
    match stop_desk::ask(&args.port) {
        stop_desk::Answer::Nobody => {}
        stop_desk::Answer::Stopped => {
            let document = StopDocument {
                state: "stopped".into(),
                pose: None,
                by: Some("the program that has its port".into()),
            };
            return output.result(&document, "stopped by the program that has its port");
        }
        stop_desk::Answer::Unconfirmed => return Err(DriveError::StopUnconfirmed.into()),
    }
    mission::with_robot(&args.port, |client| {
        mission::connect(client)?;
        let stopped = link::drive::stop(client, mission::interrupted)?;
        let pose = legs::from_wire(stopped.pose);
        let state = run::state_name(stopped.state).into();
        let document = StopDocument { state, pose: Some(pose), by: None };
        output.result(&document, "stopped")
    })
}

/// A link to whoever is behind the port of that name, on an endless floor if simulated.
pub(crate) fn open_client(port: &str) -> Result<LinkClient<Box<dyn Endpoint>>, CliError> {
    let nowhere = SimulatedWorld::nowhere(1);
    let endpoint = endpoint::open(port, nowhere, SimulatedRobot::Default)?;
    let nonce = endpoint.nonce();
    Ok(LinkClient::new(endpoint, nonce))
}
