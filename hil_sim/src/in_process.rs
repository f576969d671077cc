//! The firmware's logic in this process, without a board: [`Robot`] ticked every 5 ms.

use crate::simulation::Firmware;
use firmware::parameter_store::Step;
use firmware::robot::{Boot, Port, Robot, Sensors};
use protocol::frame::MAX_FRAME;
use protocol::message::{Board, ResetCause};
use protocol::motion::TICK_MILLISECONDS;
use protocol::parameters::Parameters;
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// The robot's logic as [`Firmware`].
#[derive(Clone, Debug)]
pub struct InProcess {
    robot: Robot,
    battery: Option<f32>,
    /// With which parameters, nonce and chip it has started.
    made: (Parameters, u32, u64),
    flash: Flash,
    /// The base's counts when this start began: the board's own counters begin at zero.
    first_counts: Option<[i32; 2]>,
}

/// What the robot's flash holds, for one that starts again: the two slots of its parameters.
pub type Flash = [Vec<u8>; 2];

impl InProcess {
    /// A robot with `parameters` that has just started; `nonce` distinguishes this start from others.
    pub fn new(parameters: Parameters, nonce: u32) -> Self {
        Self::with_flash(parameters, nonce, Flash::default())
    }

    /// The default robot at its first start, with a chip of this number.
    pub fn numbered(chip: u64) -> Self {
        Self::boot(Parameters::default(), 1, chip, Flash::default())
    }

    /// The same with what its flash holds from before.
    pub fn with_flash(parameters: Parameters, nonce: u32, flash: Flash) -> Self {
        Self::boot(parameters, nonce, 0, flash)
    }

    fn boot(parameters: Parameters, nonce: u32, chip: u64, flash: Flash) -> Self {
        let boot = Boot { nonce, board: Board::Simulated, reset: ResetCause::PowerOn, chip };
        let mut robot = Robot::new(parameters, boot);
        let [a, b] = &flash;
        robot.restore([a, b]);
        Self { robot, battery: None, made: (parameters, nonce, chip), flash, first_counts: None }
    }

    /// The same with a clock that has run for so many ticks.
    pub fn aged(self, ticks: u32) -> Self {
        Self { robot: self.robot.aged(ticks), ..self }
    }

    /// What the flash holds.
    pub fn flash(&self) -> &Flash {
        &self.flash
    }

    fn save(&mut self, steps: [Step; 2]) {
        let record = self.robot.parameter_record();
        for step in steps {
            match step {
                Step::Erase(slot) => self.flash[slot as usize].clear(),
                Step::Write(slot) => {
                    self.flash[slot as usize] = record.to_vec();
                    self.robot.parameters_written(&self.flash[slot as usize]);
                }
            }
        }
    }

    /// The robot, to look at.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }
}

impl Default for InProcess {
    /// The default robot, at its first start.
    fn default() -> Self {
        Self::new(Parameters::default(), 1)
    }
}

impl Firmware for InProcess {
    const STEP: Duration = Duration::from_millis(TICK_MILLISECONDS as u64);

    fn step(
        &mut self,
        received: &[u8],
        counts: [i32; 2],
        sent: &mut VecDeque<u8>,
    ) -> io::Result<[f64; 2]> {
        self.robot.receive(Port::Usb, received);
        let [left, right] = *self.first_counts.get_or_insert(counts);
        let counts = [counts[0].wrapping_sub(left), counts[1].wrapping_sub(right)];
        let sensors = Sensors { counts, battery: self.battery, ..Sensors::default() };
        let actuation = self.robot.tick(&sensors);
        if let Some(steps) = actuation.save {
            self.save(steps);
        }
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

    /// Starts again with what the flash holds, and with the wheels where they are.
    fn restart(&mut self) -> io::Result<()> {
        let (defaults, nonce, chip) = self.made;
        let flash = std::mem::take(&mut self.flash);
        *self = Self { battery: self.battery, ..Self::boot(defaults, nonce + 1, chip, flash) };
        Ok(())
    }

    fn set_battery(&mut self, volts: f64) {
        self.battery = Some(volts as f32);
    }
}
