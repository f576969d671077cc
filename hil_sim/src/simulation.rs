//! A base, its world and the firmware that drives it, in virtual time; towards the host, a serial port.
//!
//! ```text
//! write ─► bytes ─► brain ─► duty ─► base ─► pose ─► world
//! read  ◄─ bytes ◄───┘  ▲            │
//!                       └── counts ◄─┘
//! ```
//! Time passes only in [`Simulation::wait`], so a run is the same every time and as fast as it computes.

use crate::base::{TruePose, WheeledBase};
use crate::world::{Encounters, World};
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::time::Duration;

/// Firmware that can be run step by step: the logic in this process, or a flashed ELF in an emulator.
pub trait Brain {
    /// How long one step lasts.
    const STEP: Duration;

    /// Lets one step pass: takes the bytes that arrived and the encoders' counts, appends the bytes
    /// it sends to `sent`, and gives the motors' duty, left and right.
    ///
    /// # Errors
    /// If the firmware cannot be run any further.
    fn step(
        &mut self,
        received: &[u8],
        counts: [i32; 2],
        sent: &mut VecDeque<u8>,
    ) -> io::Result<[f64; 2]>;
}

/// A simulated robot in a simulated arena.
#[derive(Debug)]
pub struct Simulation<B> {
    brain: B,
    base: WheeledBase,
    world: Option<World>,
    encounters: Encounters,
    to_robot: Vec<u8>,
    to_host: VecDeque<u8>,
    now: Duration,
    owed: Duration,
}

/// What really happened, whatever the robot believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Where the robot is.
    pub pose: TruePose,
    /// Collisions and the smallest gap; `None` without a world.
    pub encounters: Option<Encounters>,
}

impl<B: Brain> Simulation<B> {
    /// Puts `brain` on `base` in `world`; without one, the floor is endless and empty.
    pub fn new(brain: B, base: WheeledBase, world: Option<World>) -> Self {
        Self {
            brain,
            base,
            world,
            encounters: Encounters::default(),
            to_robot: Vec::new(),
            to_host: VecDeque::new(),
            now: Duration::ZERO,
            owed: Duration::ZERO,
        }
    }

    /// Time since the start.
    pub fn now(&self) -> Duration {
        self.now
    }

    /// The firmware, for whoever means to disturb it.
    pub fn brain_mut(&mut self) -> &mut B {
        &mut self.brain
    }

    /// What really happened so far.
    pub fn truth(&self) -> Truth {
        Truth {
            pose: self.base.pose(),
            encounters: self.world.is_some().then_some(self.encounters),
        }
    }

    /// Lets `duration` pass, in whole steps of the brain; what is left over counts next time.
    ///
    /// # Errors
    /// If the firmware cannot be run any further.
    pub fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.owed += duration;
        while self.owed >= B::STEP {
            self.owed -= B::STEP;
            let received = std::mem::take(&mut self.to_robot);
            let duty = self.brain.step(&received, self.base.counts(), &mut self.to_host)?;
            self.base.step(duty, B::STEP.as_secs_f64());
            self.now += B::STEP;
            if let Some(world) = &self.world {
                self.encounters.observe(world.clearance(self.base.pose()));
            }
        }
        Ok(())
    }
}

impl<B> Read for Simulation<B> {
    /// What the robot has sent so far; like a port with nothing to say, `WouldBlock` if that is nothing.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.to_host.is_empty() {
            Err(io::ErrorKind::WouldBlock.into())
        } else {
            self.to_host.read(buffer)
        }
    }
}

impl<B> Write for Simulation<B> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.to_robot.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
