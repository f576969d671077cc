//! `wmr monitor`: a robot's pose, state, wheels, counts and battery, as they are now.

use super::args::MonitorArgs;
use super::endpoint::Endpoint;
use super::error::CliError;
use super::output::Output;
use super::{mission, run};
use protocol::message::State;
use std::time::Duration;
use wmr::document::MonitorLine;
use wmr::legs::from_wire;
use wmr::link::drive::wait_for;
use wmr::link::mission::MissionError;
use wmr::link::monitor::{INTERVAL, Monitor, Sighting};
use wmr::link::{LinkClient, LinkError};

/// Where nobody reads along, a line says what is new, and so often at least what is.
const QUIET_LINES: Duration = Duration::from_secs(1);

/// `wmr monitor`.
pub(crate) fn monitor(args: &MonitorArgs, output: Output) -> Result<(), CliError> {
    mission::with_robot(&args.port, |client| watch(client, args, output))
}

fn watch(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    args: &MonitorArgs,
    output: Output,
) -> Result<(), CliError> {
    let robot = mission::connect(client)?;
    client.check_protocol()?;
    output.say(&format!("robot: {}; Ctrl-C ends", mission::describe_robot(&robot)));
    // A simulated robot runs ahead of the clock by which a person reads.
    let paced = client.port_mut().truth().is_some();
    let began = client.port_mut().now();
    let mut monitor = Monitor::default();
    let mut last: Option<(Duration, State)> = None;
    let mut live = output.live_line();
    let finished = |now: Duration| args.r#for.is_some_and(|span| now.saturating_sub(began) >= span);
    while !mission::stop_wanted() {
        let seen = wait_for(client, mission::stop_wanted, |client, now| {
            match monitor.step(client, now)? {
                Some(sighting) => Ok(Some((now, Some(sighting)))),
                None if finished(now) => Ok(Some((now, None))),
                None => Ok::<_, LinkError>(None),
            }
        })?;
        let Some((now, Some(sighting))) = seen else { break };
        let state = sighting.telemetry.state;
        let due = last.is_none_or(|(at, was)| was != state || now - at >= QUIET_LINES);
        let mut read = true;
        if output.json {
            read = output.line(&serde_json::json!(document(&sighting)).to_string())?;
        } else if live.is_shown() {
            live.show(&text(&sighting));
        } else if due {
            last = Some((now, state));
            read = output.line(&text(&sighting))?;
        }
        if !read {
            break;
        }
        if paced {
            std::thread::sleep(INTERVAL);
        }
    }
    if mission::interrupted() || !mission::stop_wanted() {
        return Ok(());
    }
    Err(MissionError::Stopped.into())
}

fn document(Sighting { telemetry, measurement }: &Sighting) -> MonitorLine {
    let fault = match telemetry.state {
        State::Faulted(fault) => Some(fault),
        _ => None,
    };
    MonitorLine {
        t: f64::from(telemetry.ticks) / f64::from(protocol::motion::TICKS_PER_SECOND),
        state: run::state_name(telemetry.state).into(),
        fault,
        pose: from_wire(telemetry.pose),
        wheels: [telemetry.wheels.left.0, telemetry.wheels.right.0],
        leg: telemetry.leg,
        counts: measurement.counts,
        skipped: measurement.skipped,
        battery: measurement.battery,
    }
}

fn text(Sighting { telemetry, measurement }: &Sighting) -> String {
    let state = match telemetry.state {
        State::Faulted(fault) => format!("faulted: {}", fault.explanation()),
        state => run::state_name(state).to_owned(),
    };
    let [left, right] = measurement.counts;
    let battery = match measurement.battery {
        Some(volts) => format!("{volts:.2} V"),
        None => "not measured".into(),
    };
    let lost = match measurement.skipped {
        [0, 0] => String::new(),
        [left, right] => format!("  lost counts in {left} and {right} ticks"),
    };
    let place = mission::place(from_wire(telemetry.pose));
    let wheels = telemetry.wheels;
    format!(
        "{state}  {place}  counts {left} {right}  wheels {:.2} {:.2} rad/s  battery {battery}{lost}",
        wheels.left.0, wheels.right.0
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::message::{Fault, Measurement, Telemetry};
    use protocol::motion::{Pose, WheelSpeeds};

    #[test]
    fn a_sighting_in_words() {
        let telemetry = Telemetry {
            ticks: 200,
            pose: Pose::new(0.3, 0.5, 0.0),
            wheels: WheelSpeeds::default(),
            state: State::Faulted(Fault::Battery),
            leg: 0,
        };
        let measurement = Measurement { counts: [12, -7], skipped: [0, 3], battery: Some(4.1) };
        let seen = Sighting { telemetry, measurement };
        let line = text(&seen);
        for part in ["battery is empty", "(0.300, 0.500)", "12 -7", "4.10 V", "in 0 and 3 ticks"] {
            assert!(line.contains(part), "{part}: {line}");
        }
        assert_eq!(document(&seen).counts, [12, -7]);
        assert_eq!(document(&seen).t, 1.0);
    }
}
