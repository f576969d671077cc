//! The firmware's logic in this process, without a board: [`Robot`] ticked every 5 ms.

use crate::simulation::Brain;
use firmware::parameters::Parameters;
use firmware::robot::{Boot, Port, Robot, Sensors};
use firmware::wheel_loop::WheelLoopGains;
use protocol::frame::MAX_FRAME;
use protocol::message::Board;
use protocol::motion::TICK_MILLISECONDS;
use protocol::units::MetresPerSecond;
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// The robot's logic as a [`Brain`].
#[derive(Debug)]
pub struct InProcess {
    robot: Robot,
}

impl InProcess {
    /// A robot with `parameters` that has just started; `nonce` tells this start from others.
    pub fn new(parameters: Parameters, nonce: u32) -> Self {
        Self { robot: Robot::new(parameters, Boot { nonce, board: Board::Simulated }) }
    }

    /// The robot, to look at.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }
}

/// The robot of the paper's experiment, as far as its figures tell.
///
/// *Deviation:* the paper names no limits of its robot, but its mission of three legs in 9 s each has a
/// drive of 1.05 m in 3 s, which peaks at 2 D/ε = 0.7 m/s; the default robot allows 0.4 m/s and could
/// reach 0.63 m/s. So this one has motors twice as fast, and limits to match.
pub fn paper_robot() -> Parameters {
    let default = Parameters::default();
    let wheel_loop = WheelLoopGains {
        no_load_speed: PAPER_SPEED_UP * default.wheel_loop.no_load_speed,
        ..default.wheel_loop
    };
    let speed = MetresPerSecond(PAPER_SPEED_UP * default.speed.0);
    Parameters { speed, wheel_loop, ..default }
}

/// How much faster the paper's robot is than the default one.
pub(crate) const PAPER_SPEED_UP: f32 = 2.0;

impl Default for InProcess {
    /// The default robot, at its first start.
    fn default() -> Self {
        Self::new(Parameters::default(), 1)
    }
}

impl Brain for InProcess {
    const STEP: Duration = Duration::from_millis(TICK_MILLISECONDS as u64);

    fn step(
        &mut self,
        received: &[u8],
        counts: [i32; 2],
        sent: &mut VecDeque<u8>,
    ) -> io::Result<[f64; 2]> {
        self.robot.receive(Port::Usb, received);
        let actuation = self.robot.tick(&Sensors { counts });
        let mut frame = [0; MAX_FRAME];
        loop {
            let length = self.robot.transmit(Port::Usb, &mut frame);
            if length == 0 {
                break;
            }
            sent.extend(&frame[..length]);
        }
        Ok(actuation.duty.map(f64::from))
    }
}
