//! Frames damaged at random, to be refused: bits, bytes, cuts, bursts, and pieces of other frames.

use fastrand::Rng;
use protocol::frame::{Header, MAX_FRAME, decode, encode};
use protocol::message::{Command, Placement, PlanHeader, Reboot, plan_digest};
use protocol::motion::{Direction, Leg, Pose, Position, Timing};
use protocol::units::Radians;

/// What became of damaged frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdicts {
    /// Refused.
    pub refused: u64,
    /// Read as what was sent: the damage undid itself, or left the one frame of two.
    pub unharmed: u64,
    /// Read as something that was not sent.
    pub misread: u64,
}

/// Damages `frames` frames, drawn from `seed`, and reads them.
///
/// # Panics
/// If a message does not fit into a frame.
pub fn damage_frames(frames: u64, seed: u64) -> Verdicts {
    let mut random = Rng::with_seed(seed);
    let mut verdicts = Verdicts::default();
    let (mut other_sent, mut other) = frame(&mut random);
    for _ in 0..frames {
        let (sent, wire) = frame(&mut random);
        let mut damaged = wire.clone();
        damage(&mut damaged, &other, &mut random);
        let untouched = damaged == wire;
        match decode::<Command>(&mut damaged) {
            _ if untouched => verdicts.unharmed += 1,
            Err(_) => verdicts.refused += 1,
            Ok(read) if read == sent || read == other_sent => verdicts.unharmed += 1,
            Ok(_) => verdicts.misread += 1,
        }
        (other_sent, other) = (sent, wire);
    }
    verdicts
}

/// A frame without its closing zero, and what it says.
fn frame(random: &mut Rng) -> ((Header, Command), Vec<u8>) {
    let header = Header {
        session: random.u32(..),
        sequence: random.bool().then(|| random.u16(..)),
        ack: random.u16(..),
        ack_bits: random.u8(..),
    };
    let command = command(random);
    let mut wire = [0; MAX_FRAME];
    let Ok(length) = encode(&header, &command, &mut wire) else { panic!("{command:?}") };
    ((header, command), wire[..length - 1].to_vec())
}

fn command(random: &mut Rng) -> Command {
    let plan = random.u32(..);
    let coordinate = |random: &mut Rng| random.f32() * 4.0;
    let pose = Pose::new(coordinate(random), coordinate(random), random.f32());
    let leg = Leg {
        plan,
        index: random.u16(..),
        start: pose,
        goal: Position::new(coordinate(random), coordinate(random)),
        goal_heading: random.bool().then(|| Radians(random.f32())),
        direction: if random.bool() { Direction::Forward } else { Direction::Reverse },
        timing: Timing::Limits,
    };
    match random.u8(0..8) {
        0 => Command::Heartbeat,
        1 => Command::Stop { number: random.u8(..) },
        2 => Command::Reboot(Reboot::Application),
        3 => Command::PlanBegin(PlanHeader {
            plan,
            first: random.u16(..),
            count: random.u16(..),
            digest: plan_digest(&[leg]),
            placement: Placement::Start(pose),
        }),
        4 => Command::PlanCommit { plan },
        5 => Command::Resume,
        _ => Command::PlanLeg(leg),
    }
}

fn damage(frame: &mut Vec<u8>, other: &[u8], random: &mut Rng) {
    let length = frame.len();
    match random.u8(0..6) {
        0 => {
            for _ in 0..random.u8(1..=6) {
                frame[random.usize(0..length)] ^= 1 << random.u8(0..8);
            }
        }
        1 => frame[random.usize(0..length)] = random.u8(1..),
        2 => frame.truncate(random.usize(0..length)),
        3 => {
            let start = random.usize(0..length);
            let end = random.usize(start..length) + 1;
            frame[start..end].iter_mut().for_each(|byte| *byte = random.u8(1..));
        }
        // The zero between two frames was lost, or the end of one and the start of the next.
        4 => {
            frame.truncate(random.usize(1..=length));
            frame.extend_from_slice(&other[random.usize(0..other.len())..]);
        }
        _ => {
            frame.remove(random.usize(0..length));
        }
    }
}
