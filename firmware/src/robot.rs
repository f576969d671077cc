//! The robot as a value: bytes and encoder counts in, motor duty and bytes out.
//!
//! ```text
//! receive ─► link end ─► commands ─► controller ─► duty
//! transmit ◄─ link end ◄─ reports ◄──────┘
//! ```
//! It reads no clock, owns no pin, allocates nothing and never panics. The board, the simulator and
//! the tests call the same three: [`Robot::receive`], [`Robot::tick`], [`Robot::transmit`].

use crate::controller::{Controller, Event};
use crate::link_end::LinkEnd;
use crate::parameters::Parameters;
use heapless::Deque;
use protocol::message::{
    Board, Command, MAX_LEGS, PROTOCOL_VERSION, PauseReason, PlanRefusal, Reboot, Report,
    RobotHello, SILENCE_LIMIT_MILLISECONDS, State, Telemetry,
};
use protocol::motion::{Pose, TICK_MILLISECONDS};
use protocol::units::Milliseconds;

/// Which wire bytes come from or go to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// The USB serial port.
    Usb,
    /// The UART.
    Uart,
}

/// What the robot is told when it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boot {
    /// A number that differs from start to start.
    pub nonce: u32,
    /// What the robot runs on.
    pub board: Board,
}

/// What the robot measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// The encoders' counts since the start, left and right; they may wrap around.
    pub counts: [i32; 2],
}

/// What the robot does with its motors, and with itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actuation {
    /// The motors' duty, left and right, -1..=1; positive drives forward.
    pub duty: [f32; 2],
    /// Restart now; only ever asked for at rest.
    pub reboot: Option<Reboot>,
}

/// Reports that wait for room in the session; the host's silence stops the robot long before it
/// could end this many legs.
const WAITING_REPORTS: usize = 16;

/// One robot.
#[derive(Clone, Debug)]
pub struct Robot {
    controller: Controller,
    usb: LinkEnd,
    uart: LinkEnd,
    owner: Option<Port>,
    waiting: Deque<Report, WAITING_REPORTS>,
    reboot: Option<Reboot>,
    ticks: u32,
}

impl Robot {
    /// A robot at rest that has just started.
    pub fn new(parameters: Parameters, boot: Boot) -> Self {
        let hello = RobotHello {
            version: PROTOCOL_VERSION,
            host_nonce: 0,
            nonce: boot.nonce,
            board: boot.board,
            firmware: FIRMWARE_VERSION,
            limits: parameters.limits(),
            max_legs: MAX_LEGS as u16,
        };
        Self {
            controller: Controller::new(parameters),
            usb: LinkEnd::new(hello),
            uart: LinkEnd::new(hello),
            owner: None,
            waiting: Deque::new(),
            reboot: None,
            ticks: 0,
        }
    }

    /// Takes bytes from a wire, in pieces of any length.
    pub fn receive(&mut self, port: Port, bytes: &[u8]) {
        let now = self.now();
        for byte in bytes {
            if let Some(command) = self.link(port).receive(*byte, now) {
                self.obey(port, command);
            }
        }
        while let Some(command) = self.link(port).next_command() {
            self.obey(port, command);
        }
    }

    /// One control tick; to be called every 5 ms.
    pub fn tick(&mut self, sensors: &Sensors) -> Actuation {
        self.ticks = self.ticks.wrapping_add(1);
        let now = self.now();
        let silence = self.owner.and_then(|port| self.link(port).silence(now));
        if silence.is_none_or(|silence| silence > SILENCE_LIMIT_MILLISECONDS) {
            self.controller.pause(PauseReason::Silence);
        }
        let (duty, event) = self.controller.tick(sensors.counts);
        match event {
            Some(Event::LegDone(result)) => self.report(Report::LegDone(result)),
            Some(Event::PlanDone { plan, pose }) => self.report(Report::PlanDone { plan, pose }),
            None => {}
        }
        self.flush();
        let reboot = if self.controller.is_at_rest() { self.reboot.take() } else { None };
        Actuation { duty, reboot }
    }

    /// Writes the next frame for a wire into `out`; 0 if there is nothing to say now.
    ///
    /// `out` must have [`MAX_FRAME`](protocol::frame::MAX_FRAME) bytes; a frame that does not fit is
    /// not written.
    pub fn transmit(&mut self, port: Port, out: &mut [u8]) -> usize {
        let (telemetry, now) = (self.telemetry(), self.now());
        self.link(port).transmit(telemetry, now, out)
    }

    /// Asks for a restart, as a command from the host does: [`Robot::tick`] grants it at rest.
    pub fn request_reboot(&mut self, reboot: Reboot) {
        self.reboot = Some(reboot);
    }

    /// Where the robot believes it stands.
    pub fn pose(&self) -> Pose {
        self.controller.pose()
    }

    /// What the robot does.
    pub fn state(&self) -> State {
        self.controller.state()
    }

    fn obey(&mut self, port: Port, command: Command) {
        match command {
            Command::Hello(_) if self.owner == Some(port) => {
                // A host that begins anew does not know of the plan that runs.
                self.controller.pause(PauseReason::Silence);
            }
            Command::Hello(_) | Command::Heartbeat => {}
            Command::Stop => self.controller.stop(),
            _ if !self.may_move(port) => {
                if let Command::PlanCommit { plan } = command {
                    let reason = PlanRefusal::NotOwner;
                    self.link(port).report(Report::PlanRefused { plan, reason });
                }
            }
            Command::PlanBegin(header) => self.controller.queue().begin(header),
            Command::PlanLeg(leg) => self.controller.queue().collect(leg),
            Command::PlanCommit { plan } => self.commit(port, plan),
            Command::Pause => self.controller.pause(PauseReason::Command),
            Command::Resume => self.controller.resume(),
            Command::Clear => self.controller.clear(),
            Command::Reboot(reboot) => self.request_reboot(reboot),
        }
    }

    /// One link at a time owns motion; while the robot rests, any link may take it.
    fn may_move(&self, port: Port) -> bool {
        self.owner == Some(port) || self.controller.is_at_rest()
    }

    fn commit(&mut self, port: Port, plan: u32) {
        self.owner = Some(port);
        let report = match self.controller.commit(plan) {
            Ok(()) => Report::PlanAccepted { plan },
            Err(reason) => Report::PlanRefused { plan, reason },
        };
        self.report(report);
        self.flush();
    }

    fn report(&mut self, report: Report) {
        if self.waiting.is_full() {
            self.waiting.pop_front();
        }
        // There is room now.
        let _ = self.waiting.push_back(report);
    }

    fn flush(&mut self) {
        let Some(owner) = self.owner else { return };
        while let Some(report) = self.waiting.front().copied() {
            if !self.link(owner).report(report) {
                return;
            }
            self.waiting.pop_front();
        }
    }

    fn telemetry(&self) -> Telemetry {
        Telemetry {
            ticks: self.ticks,
            pose: self.controller.pose(),
            wheels: self.controller.wheel_speeds(),
            state: self.controller.state(),
            leg: self.controller.leg(),
        }
    }

    fn link(&mut self, port: Port) -> &mut LinkEnd {
        match port {
            Port::Usb => &mut self.usb,
            Port::Uart => &mut self.uart,
        }
    }

    fn now(&self) -> Milliseconds {
        Milliseconds(self.ticks.wrapping_mul(TICK_MILLISECONDS))
    }
}

/// This crate's version: major, minor, patch.
const FIRMWARE_VERSION: [u8; 3] = [
    digits(env!("CARGO_PKG_VERSION_MAJOR")),
    digits(env!("CARGO_PKG_VERSION_MINOR")),
    digits(env!("CARGO_PKG_VERSION_PATCH")),
];

const fn digits(text: &str) -> u8 {
    let mut bytes = text.as_bytes();
    let mut value = 0;
    while let [digit, rest @ ..] = bytes {
        value = value * 10 + (*digit - b'0');
        bytes = rest;
    }
    value
}
