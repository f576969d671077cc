//! `wmr ports`, `wmr info` and `wmr stop`: what is there, who it is, and stop.

use super::args::PortArgs;
use super::endpoint::{self, Endpoint, SimulatedRobot, SimulatedWorld};
use super::error::CliError;
use super::output::Output;
use super::run;
use super::{mission, params, stop_desk};
use hil_sim::base::TruePose;
use serde_json::{Value, json};
use wmr::legs;
use wmr::link::drive::DriveError;
use wmr::link::{self, LinkClient, port};

/// `wmr ports`.
pub(crate) fn list(output: Output) -> Result<(), CliError> {
    let ports = port::list()?;
    let document: Vec<Value> = ports
        .iter()
        .map(|info| {
            let mut entry = json!({"name": info.port_name, "robot": port::is_robot(info)});
            if let (serialport::SerialPortType::UsbPort(usb), Some(fields)) =
                (&info.port_type, entry.as_object_mut())
            {
                fields.insert("vid".into(), json!(usb.vid));
                fields.insert("pid".into(), json!(usb.pid));
                fields.insert("product".into(), json!(usb.product));
                fields.insert("serial".into(), json!(usb.serial_number));
            }
            entry
        })
        .collect();
    let mut text = String::new();
    for info in &ports {
        let kind = if port::is_robot(info) { "a wmr robot" } else { "something else" };
        text += &format!("{}  {kind}\n", info.port_name);
    }
    if ports.is_empty() {
        text += "no serial ports; without a robot, use --port sim\n";
    }
    output.result(&json!({"ports": document}), &text)
}

/// `wmr info`.
pub(crate) fn info(args: &PortArgs, output: Output) -> Result<(), CliError> {
    mission::catch_interrupts();
    let mut client = open_client(&args.port)?;
    let robot = mission::connect(&mut client)?;
    let ([major, minor, patch], limits) = (robot.firmware, robot.limits);
    let document = json!({
        "board": format!("{:?}", robot.board),
        "firmware": format!("{major}.{minor}.{patch}"),
        "protocol": robot.version,
        "reset": robot.reset,
        "limits": {
            "speed": params::shortest(limits.speed.0),
            "acceleration": params::shortest(limits.acceleration.0),
            "track": params::shortest(limits.track.0),
        },
        "max_legs": robot.max_legs,
    });
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
    // Whoever drives it has its port.
    match stop_desk::ask(&args.port) {
        stop_desk::Answer::Nobody => {}
        stop_desk::Answer::Stopped => {
            let document = json!({"state": "stopped", "by": "the program that drove it"});
            return output.result(&document, "stopped by the program that drove it");
        }
        stop_desk::Answer::Unconfirmed => return Err(DriveError::StopUnconfirmed.into()),
    }
    let mut client = open_client(&args.port)?;
    mission::connect(&mut client)?;
    let stopped = link::drive::stop(&mut client, mission::interrupted)?;
    let pose = legs::from_wire(stopped.pose);
    let document = json!({"state": run::state_name(stopped.state), "pose": pose});
    output.result(&document, "stopped")
}

/// A link to whoever is behind the port of that name, on an endless floor if simulated.
pub(crate) fn open_client(port: &str) -> Result<LinkClient<Box<dyn Endpoint>>, CliError> {
    let nowhere = SimulatedWorld { world: None, start: TruePose::default(), seed: 1 };
    let endpoint = endpoint::open(port, nowhere, SimulatedRobot::Default)?;
    let nonce = endpoint.nonce();
    Ok(LinkClient::new(endpoint, nonce))
}
