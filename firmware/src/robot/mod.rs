//! The robot as a value: bytes and encoder counts in, motor duty and bytes out.
//!
//! ```text
//! receive ─► link end ─► commands ─► controller ─► duty
//! transmit ◄─ link end ◄─ reports ◄──────┘
//! ```
//! It reads no clock, owns no pin, allocates nothing and never panics. The board, the simulator and
//! the tests call the same three: [`Robot::receive`], [`Robot::tick`], [`Robot::transmit`].

mod commands;

use crate::controller::Controller;
use crate::light;
use crate::link_end::{LinkEnd, Received};
use crate::outbox::Outbox;
use crate::parameter_store::{ParameterStore, RECORD_SIZE};
pub use crate::signals::{Actuation, Boot, Sensors};
use crate::signals::{Event, Outcome};
use crate::version::{FIRMWARE_GIT, FIRMWARE_VERSION};
use protocol::message::{
    Driven, MAX_LEGS, PROTOCOL_VERSION, PauseReason, Reboot, Report, RobotHello,
    SILENCE_LIMIT_MILLISECONDS, State, Telemetry,
};
use protocol::motion::{Pose, TICK_MILLISECONDS};
use protocol::parameters::ParameterRefusal;
use protocol::parameters::Parameters;
use protocol::schema::SCHEMA_HASH;
use protocol::units::Milliseconds;

/// Which wire bytes come from or go to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// The USB serial port.
    Usb,
    /// The UART.
    Uart,
}

/// One robot.
#[derive(Clone, Debug)]
pub struct Robot {
    controller: Controller,
    usb: LinkEnd,
    uart: LinkEnd,
    owner: Option<Port>,
    outbox: Outbox,
    driven: Option<Driven>,
    reboot: Option<Reboot>,
    store: ParameterStore,
    save: Save,
    ticks: u32,
    chip: u64,
}

/// A save on its way to the flash, which takes longer than a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Save {
    None,
    Asked,
    UnderWay,
}

impl Robot {
    /// A robot at rest that has just started.
    pub fn new(parameters: Parameters, boot: Boot) -> Self {
        let hello = RobotHello {
            version: PROTOCOL_VERSION,
            schema: SCHEMA_HASH,
            host_nonce: 0,
            nonce: boot.nonce,
            board: boot.board,
            reset: boot.reset,
            firmware: FIRMWARE_VERSION,
            git: FIRMWARE_GIT,
            limits: parameters.limits(),
            max_legs: MAX_LEGS as u16,
            driven: None,
        };
        Self {
            controller: Controller::new(parameters),
            usb: LinkEnd::new(hello),
            uart: LinkEnd::new(hello),
            owner: None,
            outbox: Outbox::default(),
            driven: None,
            reboot: None,
            store: ParameterStore::read([&[], &[]]).0,
            save: Save::None,
            ticks: 0,
            chip: boot.chip,
        }
    }

    /// The same with a clock that has run for so many ticks, as it has on a robot that is never switched off.
    pub fn aged(self, ticks: u32) -> Self {
        Self { ticks, ..self }
    }

    /// Takes the parameters that the flash holds in its two slots, if there are any; to be called
    /// before the first tick.
    pub fn restore(&mut self, slots: [&[u8]; 2]) {
        let (store, parameters) = ParameterStore::read(slots);
        self.store = store;
        if let Some(parameters) = parameters {
            // They were checked when they were read, and nothing moves yet.
            let _ = self.take_parameters(parameters);
        }
    }

    /// The record that [`Actuation::save`] is about.
    pub fn parameter_record(&self) -> [u8; RECORD_SIZE] {
        self.store.save(self.controller.parameters()).1
    }

    /// Takes in what the slot holds after a save, and reports the result.
    pub fn parameters_written(&mut self, read_back: &[u8]) {
        self.save = Save::None;
        let report = if self.store.confirm(self.controller.parameters(), read_back) {
            Report::ParametersSaved { sequence: self.store.sequence() }
        } else {
            Report::ParametersRefused(ParameterRefusal::NotStored)
        };
        self.report(report);
        self.flush();
    }

    /// Takes bytes from a wire, in pieces of any length.
    pub fn receive(&mut self, port: Port, bytes: &[u8]) {
        let now = self.now();
        for byte in bytes {
            match self.link(port).receive(*byte, now) {
                Some(Received::NewHost) => self.on_new_host(port),
                Some(Received::Urgent(command)) => self.handle_command(port, command),
                None => {}
            }
        }
        self.take_commands(port);
    }

    /// One control tick; to be called every 5 ms. Where the board missed some, `sensors` says so and
    /// the robot's clock makes up for them.
    pub fn tick(&mut self, sensors: &Sensors) -> Actuation {
        self.ticks = self.ticks.wrapping_add(1 + u32::from(sensors.missed_ticks));
        let now = self.now();
        let silence = self.owner.and_then(|port| self.link(port).silence(now));
        // Behind a flood nobody would hear a stop in time: it counts as silence.
        let flooded = self.usb.is_flooded() || self.uart.is_flooded();
        if flooded || silence.is_none_or(|silence| silence > SILENCE_LIMIT_MILLISECONDS) {
            self.controller.pause(PauseReason::Silence);
        }
        self.usb.pass();
        self.uart.pass();
        let Outcome { duty, event, battery } = self.controller.tick(sensors);
        if let Some(battery) = battery {
            self.report(Report::Battery(battery));
        }
        match event {
            Some(Event::LegDone(result)) => self.outbox.leg_done(result),
            Some(Event::PlanDone { plan, pose }) => {
                // A stop at the very end has made the controller forget the plan.
                let driven = self.controller.driven().or(self.driven);
                let end = driven.map_or(0, |driven| driven.end);
                self.outbox.plan_ended(Report::PlanDone { plan, end, pose });
            }
            Some(Event::WheelTurned(counts)) => self.report(Report::WheelTurned { counts }),
            None => {}
        }
        self.report_stop();
        self.flush();
        for port in [Port::Usb, Port::Uart] {
            self.take_commands(port);
        }
        let reboot = if self.controller.is_at_rest() { self.reboot.take() } else { None };
        let light =
            light::is_on(self.controller.state(), self.controller.battery_level(), self.ticks);
        Actuation { duty, light, reboot, save: self.due_save() }
    }

    /// Writes the next frame for a wire into `out`; 0 if there is nothing to say now.
    ///
    /// `out` must have [`MAX_FRAME`](protocol::frame::MAX_FRAME) bytes; a frame that does not fit is
    /// not written.
    pub fn transmit(&mut self, port: Port, out: &mut [u8]) -> usize {
        let now = self.now();
        let driven = self.controller.driven();
        let Self { controller, usb, uart, ticks, .. } = self;
        let telemetry = || telemetry(controller, *ticks);
        match port {
            Port::Usb => usb.transmit(telemetry, driven, now, out),
            Port::Uart => uart.transmit(telemetry, driven, now, out),
        }
    }

    /// Asks for a restart, as a command from the host does; passed over unless the robot rests.
    pub fn request_reboot(&mut self, reboot: Reboot) {
        // Not kept for later: what is asked while driving must not follow the mission's end.
        if self.controller.is_at_rest() {
            self.reboot = Some(reboot);
        }
    }

    /// What the divider before the battery pin divides by; 0 for none fitted.
    pub fn battery_divider(&self) -> f32 {
        self.controller.parameters().divider()
    }

    /// Where the robot believes it stands.
    pub fn pose(&self) -> Pose {
        self.controller.pose()
    }

    /// What the robot does.
    pub fn state(&self) -> State {
        self.controller.state()
    }

    /// A new host does not know of the plan that runs; hello reports how far it was driven.
    fn on_new_host(&mut self, port: Port) {
        if self.owner == Some(port) {
            self.controller.pause(PauseReason::Silence);
            self.outbox = Outbox::default();
            self.report_battery();
        }
    }

    /// A stop or fault makes the controller forget its plan; a report says how far it came.
    fn report_stop(&mut self) {
        let driven = self.controller.driven();
        if let (Some(Driven { plan, next, end }), None) = (self.driven, driven)
            && next != end
        {
            let (state, pose) = (self.controller.state(), self.controller.pose());
            let wheel = self.controller.faulty_wheel();
            let wheel = wheel.filter(|_| matches!(state, State::Faulted(_)));
            self.outbox.plan_ended(Report::PlanStopped { plan, next, state, pose, wheel });
        }
        self.driven = driven;
    }

    /// Answers the owner. Before a command is taken there is room; what the robot says unasked is
    /// dropped where the owner does not listen.
    fn report(&mut self, report: Report) {
        if self.owner.is_some() {
            self.outbox.answer(report);
        }
    }

    /// From now on `port` owns the robot.
    fn own(&mut self, port: Port) {
        if self.owner != Some(port) {
            // What the last owner has not received by now is in the next hello.
            self.outbox = Outbox::default();
            self.owner = Some(port);
            self.report_battery();
        }
    }

    /// Says again what was said when it began, maybe to nobody or to another host.
    fn report_battery(&mut self) {
        if let Some(battery) = self.controller.battery() {
            self.report(Report::Battery(battery));
        }
    }

    /// Hands over what there is to report as the session has room: answers, ends of legs in their
    /// order, and the end of the plan behind them.
    fn flush(&mut self) {
        let Some(owner) = self.owner else { return };
        while let Some(report) = self.outbox.next() {
            if !self.link(owner).report(report) {
                return;
            }
            self.outbox.advance();
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

fn telemetry(controller: &Controller, ticks: u32) -> Telemetry {
    Telemetry {
        ticks,
        pose: controller.pose(),
        wheels: controller.wheel_speeds(),
        state: controller.state(),
        leg: controller.leg(),
    }
}
