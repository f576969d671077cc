//! Runs a simulation in step with the clock on the wall, behind a port for other programs.

use crate::simulation::{Firmware, Simulation};
use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// How often the port is looked at.
const PAUSE: Duration = Duration::from_millis(1);

/// A computer that was busy or asleep for longer than this does not catch up: to the robot, and to
/// its watch over the host's silence, the gap did not happen.
const LONGEST_GAP: Duration = Duration::from_millis(100);

/// Carries bytes between `simulation` and `port` in real time until `goes_on` says no.
///
/// What the other side does not take at once is dropped, as on a serial cable without a listener.
///
/// # Errors
/// If the port or the firmware fails.
pub fn run<B: Firmware>(
    simulation: &mut Simulation<B>,
    port: &mut (impl Read + Write),
    mut goes_on: impl FnMut(&mut Simulation<B>) -> bool,
) -> io::Result<()> {
    let mut buffer = [0; 4096];
    let mut last = Instant::now();
    while goes_on(simulation) {
        if let Some(length) = or_nothing(port.read(&mut buffer))? {
            simulation.write_all(&buffer[..length])?;
        }
        let gap = last.elapsed();
        last += gap;
        simulation.wait(gap.min(LONGEST_GAP))?;
        while let Some(length) = or_nothing(simulation.read(&mut buffer))? {
            if or_nothing(port.write(&buffer[..length]))?.is_none() {
                break;
            }
        }
        std::thread::sleep(PAUSE);
    }
    Ok(())
}

/// The length that was read or written, or `None` if there is nothing to read or no room now.
pub(crate) fn or_nothing(result: io::Result<usize>) -> io::Result<Option<usize>> {
    match result {
        Ok(length) => Ok(Some(length)),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}
