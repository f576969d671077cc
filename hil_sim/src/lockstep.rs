//! Somebody else's physics in the base's place, over TCP, one JSON line each way a step.
//!
//! ```text
//! host ═bytes═ firmware ─► {"t":0.005,"duty":[0.1,0.1]} ─► physics
//!                ▲                                         │
//!                └── {"counts":[3,3],"battery":7.4} ◄──────┘
//! ```
//! Time advances only by answers, so the physics may take as long as they like. Counts are absolute;
//! the battery may be left out. Towards the host it is a port, as [`Simulation`](crate::simulation::Simulation) is.

use crate::realtime::or_nothing;
use crate::simulation::Firmware;
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// The longest line that is read, bytes; an answer takes some sixty.
const LONGEST_LINE: u64 = 4096;

/// How often somebody who waits for the physics is asked whether to go on.
const LISTEN: Duration = Duration::from_millis(100);

/// [`Firmware`] whose base is at the other end of a socket.
#[derive(Debug)]
pub struct Lockstep<B> {
    firmware: B,
    physics: BufReader<TcpStream>,
    step: Duration,
    counts: [i32; 2],
    now: Duration,
    stepped: Duration,
    owed: Duration,
    to_robot: Vec<u8>,
    to_host: VecDeque<u8>,
}

impl<B: Firmware> Lockstep<B> {
    /// Puts `firmware` on the base behind `physics`, which advances by `step` a line.
    ///
    /// # Errors
    /// If the socket fails, or `step` is no time at all.
    pub fn new(firmware: B, physics: TcpStream, step: Duration) -> io::Result<Self> {
        if step.is_zero() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "a step of no time"));
        }
        // Each line waits for the other: collecting them would cost 40 ms a step.
        physics.set_nodelay(true)?;
        physics.set_read_timeout(Some(LISTEN))?;
        Ok(Self {
            firmware,
            physics: BufReader::new(physics),
            step,
            counts: [0, 0],
            now: Duration::ZERO,
            stepped: Duration::ZERO,
            owed: Duration::ZERO,
            to_robot: Vec::new(),
            to_host: VecDeque::new(),
        })
    }

    /// Time since the start.
    pub fn now(&self) -> Duration {
        self.now
    }

    /// Lets `duration` pass, in whole steps of the firmware; what is left over counts next time.
    ///
    /// # Errors
    /// If the firmware cannot be run any further, or the physics do not answer as they should.
    pub fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.wait_while(duration, &mut || true)
    }

    /// As [`wait`](Self::wait), but `Interrupted` as soon as `goes_on` says no to silent physics; the
    /// base is of no use after that.
    fn wait_while(
        &mut self,
        duration: Duration,
        goes_on: &mut impl FnMut() -> bool,
    ) -> io::Result<()> {
        self.owed += duration;
        while self.owed >= B::STEP {
            self.owed -= B::STEP;
            let received = std::mem::take(&mut self.to_robot);
            let duty = self.firmware.step(&received, self.counts, &mut self.to_host)?;
            self.now += B::STEP;
            while self.stepped + self.step <= self.now {
                self.stepped += self.step;
                self.exchange(duty, goes_on)?;
            }
        }
        Ok(())
    }

    fn exchange(&mut self, duty: [f64; 2], goes_on: &mut impl FnMut() -> bool) -> io::Result<()> {
        let line = json!({ "t": self.stepped.as_secs_f64(), "duty": duty });
        writeln!(self.physics.get_mut(), "{line}")?;
        let answer = self.answer(goes_on)?;
        let (counts, battery) = parse(&answer).ok_or_else(|| {
            let help = r#"expected {"counts":[left,right]} with whole numbers, not "#;
            io::Error::new(ErrorKind::InvalidData, format!("{help}{}", answer.trim_end()))
        })?;
        self.counts = counts;
        if let Some(volts) = battery {
            self.firmware.set_battery(volts);
        }
        Ok(())
    }

    fn answer(&mut self, goes_on: &mut impl FnMut() -> bool) -> io::Result<String> {
        let mut answer = Vec::new();
        loop {
            // What has come before the time was over stays in `answer`.
            let room = LONGEST_LINE - answer.len() as u64;
            match self.physics.by_ref().take(room).read_until(b'\n', &mut answer) {
                Ok(_) if answer.is_empty() => {
                    return Err(io::Error::new(ErrorKind::UnexpectedEof, "the physics have gone"));
                }
                Ok(_) => return Ok(String::from_utf8_lossy(&answer).into_owned()),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    if !goes_on() {
                        return Err(ErrorKind::Interrupted.into());
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }
}

/// Counts wrap at 32 bits, as the robot's do.
fn parse(answer: &str) -> Option<([i32; 2], Option<f64>)> {
    let answer: Value = serde_json::from_str(answer).ok()?;
    let [left, right] = answer.get("counts")?.as_array()?.as_slice() else { return None };
    let battery = answer.get("battery").map(|volts| volts.as_f64());
    if battery == Some(None) {
        return None;
    }
    Some(([left.as_i64()? as i32, right.as_i64()? as i32], battery.flatten()))
}

/// How simulated time follows the clock on the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pacing {
    /// Never ahead of it.
    RealTime,
    /// As fast as the physics answer.
    Fast,
}

/// Carries bytes between `lockstep` and `port` until `goes_on` says no.
///
/// What the other side does not take at once is dropped, as on a serial cable without a listener.
///
/// # Errors
/// If the port, the firmware or the physics fail.
pub fn run<B: Firmware>(
    lockstep: &mut Lockstep<B>,
    port: &mut (impl Read + Write),
    pacing: Pacing,
    mut goes_on: impl FnMut() -> bool,
) -> io::Result<()> {
    let started = Instant::now();
    let mut buffer = [0; 4096];
    while goes_on() {
        if let Some(length) = or_nothing(port.read(&mut buffer))? {
            lockstep.write_all(&buffer[..length])?;
        }
        match lockstep.wait_while(B::STEP, &mut goes_on) {
            Err(error) if error.kind() == ErrorKind::Interrupted => break,
            result => result?,
        }
        while let Some(length) = or_nothing(lockstep.read(&mut buffer))? {
            if or_nothing(port.write(&buffer[..length]))?.is_none() {
                break;
            }
        }
        if pacing == Pacing::RealTime {
            std::thread::sleep(lockstep.now().saturating_sub(started.elapsed()));
        }
    }
    Ok(())
}

impl<B> Read for Lockstep<B> {
    /// What the robot has sent so far; like a port with nothing to say, `WouldBlock` if that is nothing.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.to_host.is_empty() {
            Err(ErrorKind::WouldBlock.into())
        } else {
            self.to_host.read(buffer)
        }
    }
}

impl<B> Write for Lockstep<B> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.to_robot.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read_or_refused() {
        assert_eq!(parse(r#"{"counts":[3,-4]}"#), Some(([3, -4], None)));
        assert_eq!(parse(r#"{"counts":[3,-4],"battery":7.4}"#), Some(([3, -4], Some(7.4))));
        assert_eq!(parse(r#"{"counts":[2147483648,0]}"#), Some(([i32::MIN, 0], None)));
        for bad in [
            "",
            "{}",
            r#"{"counts":[1]}"#,
            r#"{"counts":[1.5,2]}"#,
            r#"{"counts":[1,2],"battery":"x"}"#,
        ] {
            assert_eq!(parse(bad), None, "{bad}");
        }
    }
}
