//! Whether what a robot says of itself in hello allows a plan at all.
//!
//! Its limits divide and bound everything that is planned for it, so they must be numbers that a robot can
//! have: those that its own parameters may take.

use super::MissionError;
use super::error::Unfit;
use protocol::message::RobotHello;
use protocol::parameters::FIELDS;

/// Checks room and limits of a robot, before anything is planned with them.
///
/// # Errors
/// [`MissionError::Unfit`] with the number that is wrong.
pub fn check_robot(robot: &RobotHello) -> Result<(), MissionError> {
    let limits = robot.limits;
    let values = [
        ("speed", limits.speed.0),
        ("acceleration", limits.acceleration.0),
        ("track", limits.track.0),
    ];
    for (name, value) in values {
        let Some(field) = FIELDS.iter().find(|field| field.name == name) else { continue };
        if !(field.least..=field.most).contains(&value) {
            let (unit, least, most) = (field.unit, field.least, field.most);
            return Err(MissionError::Unfit(Unfit::Limit { name, value, unit, least, most }));
        }
    }
    match robot.max_legs {
        0 => Err(MissionError::Unfit(Unfit::NoRoom)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::message::{Board, MAX_LEGS, PROTOCOL_VERSION, ResetCause};
    use protocol::motion::Limits;
    use protocol::parameters::Parameters;
    use protocol::schema::SCHEMA_HASH;
    use protocol::units::{Metres, MetresPerSecond, MetresPerSecondSquared};

    fn robot(limits: Limits, max_legs: u16) -> RobotHello {
        RobotHello {
            version: PROTOCOL_VERSION,
            schema: SCHEMA_HASH,
            host_nonce: 1,
            nonce: 2,
            board: Board::Simulated,
            firmware: [0, 1, 0],
            git: 0,
            limits,
            max_legs,
            driven: None,
            reset: ResetCause::PowerOn,
        }
    }

    #[test]
    fn the_default_robot_is_fit_and_one_without_room_is_not() {
        let limits = Parameters::default().limits();
        assert!(check_robot(&robot(limits, MAX_LEGS as u16)).is_ok());
        let error = check_robot(&robot(limits, 0)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the robot cannot drive any plan: it has room for no leg at all"
        );
    }

    #[test]
    fn limits_that_no_robot_has_are_refused() {
        let [speed, acceleration, track] = [0.4, 0.8, 0.12];
        for wrong in [f32::NAN, 0.0, -1.0, f32::INFINITY, 1e-38, 3e38] {
            for place in 0..3 {
                let mut values = [speed, acceleration, track];
                values[place] = wrong;
                let limits = Limits {
                    speed: MetresPerSecond(values[0]),
                    acceleration: MetresPerSecondSquared(values[1]),
                    track: Metres(values[2]),
                };
                let error = check_robot(&robot(limits, 32)).unwrap_err();
                assert!(matches!(error, MissionError::Unfit(Unfit::Limit { .. })), "{error}");
            }
        }
    }
}
