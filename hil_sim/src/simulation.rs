//! A base, its world and the firmware that drives it, in virtual time; towards the host, a serial port.
//!
//! ```text
//! write ─► wire ─► firmware ─► duty ─► base ─► pose ─► world
//! read  ◄─ wire ◄───┘  ▲            │
//!                      └── counts ◄─┘
//! ```
//! Time passes only in [`Simulation::wait`], so a run is the same every time and as fast as it computes.

use crate::base::{TruePose, WheeledBase};
use crate::camera::{Exposure, Frame, Stream};
use crate::motion::{Motion, Mover};
use crate::script::{Change, Condition, Glance, Script, Timeline};
use crate::wire::{Faults, Pace, Wire};
use crate::world::{CollisionLog, Shape, World};
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::time::Duration;

/// Firmware that can be run step by step: the logic in this process, or a flashed ELF in an emulator.
pub trait Firmware {
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

    /// The battery's voltage from now on, for firmware whose board measures it, volts.
    fn set_battery(&mut self, _volts: f64) {}

    /// Takes the power away and gives it back; flash keeps its content.
    ///
    /// # Errors
    /// If the firmware cannot be run any further, or has no power of its own.
    fn restart(&mut self) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// No base of this size is faster, m/s.
const FASTEST: f64 = 5.0;

/// A simulated robot in a simulated arena.
#[derive(Clone, Debug)]
pub struct Simulation<B> {
    firmware: B,
    base: WheeledBase,
    world: Option<World>,
    camera: Option<Stream>,
    /// Whether shapes and walls keep the robot out, or are only watched.
    solid: bool,
    collision_log: CollisionLog,
    to_robot: Wire,
    to_host: Wire,
    arrived: VecDeque<u8>,
    now: Duration,
    owed: Duration,
    timeline: Option<Timeline>,
    /// The wires' faults and pace without a script.
    own_wires: [(Faults, Pace); 2],
    powered: bool,
}

/// What really happened, whatever the robot believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Where the robot is.
    pub pose: TruePose,
    /// Collisions and the smallest gap; `None` without a world.
    pub collision_log: Option<CollisionLog>,
}

impl<B: Firmware> Simulation<B> {
    /// Puts `firmware` on `base` in `world`; without one, the floor is endless and empty.
    pub fn new(firmware: B, base: WheeledBase, world: Option<World>) -> Self {
        Self {
            firmware,
            base,
            world,
            camera: None,
            solid: false,
            collision_log: CollisionLog::default(),
            to_robot: Wire::default(),
            to_host: Wire::default(),
            arrived: VecDeque::new(),
            now: Duration::ZERO,
            owed: Duration::ZERO,
            timeline: None,
            own_wires: Default::default(),
            powered: true,
        }
    }

    /// From now on `script` runs, in place of any other.
    pub fn run_script(&mut self, script: Script) {
        self.own_wires = [self.to_robot.quality(), self.to_host.quality()];
        self.timeline = Some(Timeline::new(script, self.now));
    }

    /// Since when a script runs, if one does.
    pub fn script_began(&self) -> Option<Duration> {
        self.timeline.as_ref().map(Timeline::began)
    }

    /// The same with these wires, to the robot and to the host, in place of perfect ones.
    pub fn with_wires(self, to_robot: Wire, to_host: Wire) -> Self {
        Self { to_robot, to_host, ..self }
    }

    /// The same with shapes and walls that the robot bumps against; else it passes through, and only the
    /// collision is counted.
    pub fn with_solid_shapes(self) -> Self {
        Self { solid: true, ..self }
    }

    /// The same with a camera over its world; without a world there is nothing to see.
    pub fn with_camera(self, camera: Stream) -> Self {
        Self { camera: Some(camera), ..self }
    }

    /// The camera, to inject faults.
    pub fn camera_mut(&mut self) -> Option<&mut Stream> {
        self.camera.as_mut()
    }

    /// The next frame that the camera has delivered by now.
    pub fn take_frame(&mut self) -> Option<Frame> {
        let now = self.now();
        self.camera.as_mut()?.take(now)
    }

    /// The same before it is drawn.
    pub fn take_exposure(&mut self) -> Option<Exposure> {
        let now = self.now();
        self.camera.as_mut()?.take_exposure(now)
    }

    /// From now on the robot stands at `pose`, which it does not know, in `world` or, without one, where it has
    /// been; over it hangs this camera. Collisions are counted anew.
    pub fn arrange(&mut self, world: Option<World>, pose: TruePose, camera: Stream) {
        self.world = world.or(self.world.take());
        self.camera = Some(camera);
        self.base.place(pose);
        self.collision_log = CollisionLog::default();
    }

    /// The wires, to the robot and to the host.
    pub fn wires(&mut self) -> [&mut Wire; 2] {
        [&mut self.to_robot, &mut self.to_host]
    }

    /// Time since the start.
    pub fn now(&self) -> Duration {
        self.now + self.owed
    }

    /// The firmware, to inject faults.
    pub fn firmware_mut(&mut self) -> &mut B {
        &mut self.firmware
    }

    /// The base, to inject faults.
    pub fn base_mut(&mut self) -> &mut WheeledBase {
        &mut self.base
    }

    /// The world as it is now, if there is one.
    pub fn world(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// What really happened so far.
    pub fn truth(&self) -> Truth {
        Truth {
            pose: self.base.pose(),
            collision_log: self.world.is_some().then_some(self.collision_log),
        }
    }

    /// Lets `duration` pass, in whole steps of the firmware; what is left over counts next time.
    ///
    /// # Errors
    /// If the firmware cannot be run any further.
    pub fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.owed += duration;
        while self.owed >= B::STEP {
            self.owed -= B::STEP;
            self.now += B::STEP;
            self.follow_script()?;
            self.world.iter_mut().for_each(|world| world.advance(self.now));
            let mut received = Vec::new();
            while let Some(bytes) = self.to_robot.read(self.now) {
                received.extend(bytes);
            }
            let duty = if self.powered { self.step_firmware(&received)? } else { [0.0; 2] };
            self.move_base(duty, B::STEP.as_secs_f64());
            if let (Some(camera), Some(world)) = (&mut self.camera, &self.world) {
                let pose = self.base.pose();
                camera.expose(self.now, |camera| camera.look().stage(world, pose));
            }
        }
        Ok(())
    }

    fn step_firmware(&mut self, received: &[u8]) -> io::Result<[f64; 2]> {
        let mut sent = VecDeque::new();
        let duty = self.firmware.step(received, self.base.counts(), &mut sent)?;
        self.to_host.write(sent.make_contiguous(), self.now);
        Ok(duty)
    }

    fn follow_script(&mut self) -> io::Result<()> {
        let Some(timeline) = &mut self.timeline else { return Ok(()) };
        let glance = Glance {
            pose: self.base.pose(),
            wheel_speeds: self.base.wheel_speeds(),
            touches: self.collision_log.is_touching(),
        };
        let (changes, condition) = timeline.step(self.now, glance);
        for change in changes {
            self.change(change)?;
        }
        if let Some(Condition { base, wires, camera }) = condition {
            self.base.set_faults(base);
            self.camera.iter_mut().for_each(|stream| stream.set_faults(camera));
            let ends = [&mut self.to_robot, &mut self.to_host].into_iter().zip(wires);
            for ((wire, scripted), own) in ends.zip(self.own_wires) {
                let (faults, pace) = scripted.unwrap_or(own);
                wire.change(faults, pace);
            }
        }
        Ok(())
    }

    fn change(&mut self, change: Change) -> io::Result<()> {
        match change {
            Change::Reset => self.firmware.restart()?,
            Change::PowerOff => self.powered = false,
            Change::PowerOn => {
                self.powered = true;
                self.firmware.restart()?;
            }
            Change::Battery(volts) => self.firmware.set_battery(volts),
            Change::Push([ahead, left, turn]) => {
                let TruePose { x, y, heading } = self.base.pose();
                let (sin, cos) = heading.sin_cos();
                let x = x + ahead * cos - left * sin;
                let y = y + ahead * sin + left * cos;
                self.base.place(TruePose { x, y, heading: heading + turn });
            }
            Change::Place(pose) => self.base.place(pose),
            Change::Add(shape, motion) => self.set_down(shape, motion),
            Change::Remove(shape, motion) => {
                if let Some(world) = &mut self.world {
                    world.shapes.retain(|is| *is != shape || motion != Motion::Still);
                    world.movers.retain(|mover| !mover.is_made_of(&shape, &motion));
                }
            }
        }
        Ok(())
    }

    /// A shape that comes into the world, if there is one, and moves or stays.
    pub fn set_down(&mut self, shape: Shape, motion: Motion) {
        let Some(world) = &mut self.world else { return };
        match motion {
            Motion::Still => world.shapes.push(shape),
            motion => world.movers.push(Mover::new(shape, motion, self.now)),
        }
    }

    fn move_base(&mut self, duty: [f64; 2], seconds: f64) {
        let Some(world) = &self.world else { return self.base.step(duty, seconds) };
        if !self.solid {
            self.base.step(duty, seconds);
            self.collision_log.observe(world.clearance(self.base.pose()));
            return;
        }
        // Far from everything nothing can be touched within a step.
        let depth = if world.clearance(self.base.pose()) > FASTEST * seconds {
            self.base.step(duty, seconds);
            None
        } else {
            let touches = |pose| world.contact(pose);
            self.base.step_among(duty, seconds, world.robot_radius, touches)
        };
        let clearance = world.clearance(self.base.pose());
        self.collision_log.observe_among_solids(clearance, depth);
    }
}

impl<B> Read for Simulation<B> {
    /// What has arrived from the robot so far; like a port with nothing to say, `WouldBlock` if that is nothing.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while let Some(bytes) = self.to_host.read(self.now + self.owed) {
            self.arrived.extend(bytes);
        }
        if self.arrived.is_empty() {
            Err(io::ErrorKind::WouldBlock.into())
        } else {
            self.arrived.read(buffer)
        }
    }
}

impl<B> Write for Simulation<B> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.to_robot.write(buffer, self.now + self.owed);
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
