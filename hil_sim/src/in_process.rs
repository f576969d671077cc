//! The firmware's logic in this process, without a board: [`Robot`] ticked every 5 ms.

use crate::simulation::Brain;
use firmware::parameters::Parameters;
use firmware::robot::{Boot, Port, Robot, Sensors};
use protocol::frame::MAX_FRAME;
use protocol::message::Board;
use protocol::motion::TICK_MILLISECONDS;
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
