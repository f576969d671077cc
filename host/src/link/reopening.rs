//! A port that opens itself again after its cable came loose.
//!
//! To its user the port falls silent and goes on later; what is written meanwhile is lost, as on any
//! loose cable. The session above sends again what matters, and says when it has waited too long.

use super::is_nothing_yet;
use super::port::{self, PortError, Wire};
use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// A port that is gone is tried again this often.
const RETRY: Duration = Duration::from_millis(100);

/// A way to a robot that survives unplugging.
#[derive(Debug)]
pub struct Reopening {
    name: String,
    wire: Option<Wire>,
    tried: Instant,
}

impl Reopening {
    /// Opens a port as [`port::open`] does, and again by the same name whenever it fails.
    ///
    /// # Errors
    /// [`PortError`] if it cannot be opened the first time.
    pub fn open(name: &str) -> Result<Self, PortError> {
        let wire = port::open(name)?;
        Ok(Self { name: name.to_owned(), wire: Some(wire), tried: Instant::now() })
    }

    /// Whether the port is open as far as is known.
    pub fn is_open(&self) -> bool {
        self.wire.is_some()
    }

    /// The open port; tries to open it if it is time.
    fn wire(&mut self) -> Option<&mut Wire> {
        if self.wire.is_none() && self.tried.elapsed() >= RETRY {
            self.tried = Instant::now();
            self.wire = port::open(&self.name).ok();
        }
        self.wire.as_mut()
    }
}

impl Read for Reopening {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let nothing = || io::Error::from(ErrorKind::WouldBlock);
        match self.wire().ok_or_else(nothing)?.read(buffer) {
            // A serial port that ends is gone.
            Ok(0) => self.wire = None,
            Ok(length) => return Ok(length),
            Err(error) if is_nothing_yet(&error) => return Err(error),
            Err(_) => self.wire = None,
        }
        Err(nothing())
    }
}

impl Write for Reopening {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let Some(wire) = self.wire() else { return Ok(buffer.len()) };
        match wire.write(buffer) {
            Ok(length) => Ok(length),
            Err(error) => {
                if !is_nothing_yet(&error) {
                    self.wire = None;
                }
                Ok(buffer.len())
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
