//! What each command of a host does to the robot, and who may give it.

use super::{Port, Robot, Save};
use crate::parameter_store::Step;
use protocol::message::{
    CameraPose, Command, Fault, Identity, PauseReason, PlanRefusal, PoseRefusal, Report,
};
use protocol::parameters::{ParameterRefusal, Parameters};

impl Robot {
    /// Handles the commands of the reliable channel, as long as there is room for what there is to say about it. What
    /// waits there also keeps the host from sending more.
    pub(super) fn take_commands(&mut self, port: Port) {
        let owns = self.owner == Some(port);
        while self.link(port).has_room() && !(owns && self.outbox.is_full()) {
            let Some(command) = self.link(port).next_command() else { return };
            self.handle_command(port, command);
        }
    }

    pub(super) fn handle_command(&mut self, port: Port, command: Command) {
        match command {
            Command::Hello(_) | Command::Heartbeat => {}
            Command::Stop { .. } => self.controller.stop(),
            Command::EmergencyStop { .. } => self.controller.cut(Fault::EmergencyStop),
            _ if !self.link(port).same_protocol() && !matches!(command, Command::Reboot(_)) => {
                self.refuse(port, command, PlanRefusal::WrongProtocol);
            }
            Command::GetParameters => {
                let parameters = Report::Parameters(*self.controller.parameters());
                // `take_commands` has made sure of room.
                let _ = self.link(port).report(parameters);
            }
            Command::Identify => {
                let placed = self.controller.is_placed();
                let identity = Report::Identity(Identity { chip: self.chip, placed });
                let _ = self.link(port).report(identity);
            }
            Command::Measure => {
                let measured = Report::Measured(self.controller.measurement());
                let _ = self.link(port).report(measured);
            }
            _ if !self.may_move(port) => self.refuse(port, command, PlanRefusal::NotOwner),
            Command::SetParameters(_) | Command::SaveParameters => {
                self.change_parameters(port, command);
            }
            Command::PlanBegin(header) => self.controller.announce(header),
            Command::PlanLeg(leg) => self.controller.collect(leg),
            Command::PlanCommit { plan } => self.commit(port, plan),
            Command::PlanCancel { plan } => self.controller.cancel(plan),
            Command::Pause => self.controller.pause(PauseReason::Command),
            Command::Resume => self.controller.resume(),
            // A stop that overtook this was sent after it.
            Command::Clear { stop } if stop == self.link(port).last_stop() => {
                self.controller.clear();
            }
            Command::Clear { .. } => {}
            Command::Reboot(reboot) => self.request_reboot(reboot),
            Command::TurnWheel { wheel } => {
                self.own(port);
                self.controller.turn_wheel(wheel);
            }
            Command::SetPose(seen) => self.set_pose(port, seen),
        }
    }

    fn refuse(&mut self, port: Port, command: Command, reason: PlanRefusal) {
        let report = match command {
            Command::PlanCommit { plan } => Report::PlanRefused { plan, reason },
            Command::SetParameters(_) | Command::SaveParameters => {
                Report::ParametersRefused(ParameterRefusal::NotOwner)
            }
            _ => return,
        };
        // `take_commands` has made sure of room.
        let _ = self.link(port).report(report);
    }

    /// One link at a time owns motion; while the robot rests, any link may take it.
    fn may_move(&self, port: Port) -> bool {
        self.owner == Some(port) || self.controller.is_at_rest()
    }

    fn commit(&mut self, port: Port, plan: u32) {
        self.own(port);
        let room = self.outbox.room_for_legs();
        let report = match self.controller.commit(plan, room) {
            Ok(end) => Report::PlanAccepted { plan, end },
            Err(reason) => Report::PlanRefused { plan, reason },
        };
        self.report(report);
        self.flush();
    }

    fn set_pose(&mut self, port: Port, CameraPose { ticks, pose }: CameraPose) {
        let age = self.ticks.wrapping_sub(ticks);
        // Half the range of a clock that wraps is the past, half the future.
        let result = if age > u32::MAX / 2 {
            Err(PoseRefusal::InFuture)
        } else {
            self.controller.set_pose(pose, age)
        };
        if let Err(reason) = result {
            // Where there is no room, the next exposure brings the next chance.
            let _ = self.link(port).report(Report::PoseRefused { ticks, reason });
        }
    }

    pub(super) fn due_save(&mut self) -> Option<[Step; 2]> {
        if self.save != Save::Asked || !self.controller.is_at_rest() {
            return None;
        }
        self.save = Save::UnderWay;
        Some(self.store.save(self.controller.parameters()).0)
    }

    /// Whoever changes parameters owns the robot, which rests: the answers go there.
    fn change_parameters(&mut self, port: Port, command: Command) {
        self.own(port);
        let result = match command {
            _ if self.save != Save::None || !self.controller.is_at_rest() => {
                Err(ParameterRefusal::NotAtRest)
            }
            Command::SetParameters(parameters) => self.take_parameters(parameters).map(Some),
            _ => {
                self.save = Save::Asked;
                Ok(None)
            }
        };
        match result {
            Ok(Some(parameters)) => self.report(Report::Parameters(parameters)),
            // Reported when the flash has taken them.
            Ok(None) => {}
            Err(refusal) => self.report(Report::ParametersRefused(refusal)),
        }
        self.flush();
    }

    pub(super) fn take_parameters(
        &mut self,
        parameters: Parameters,
    ) -> Result<Parameters, ParameterRefusal> {
        self.controller.set_parameters(parameters)?;
        self.usb.set_limits(parameters.limits());
        self.uart.set_limits(parameters.limits());
        Ok(parameters)
    }
}
