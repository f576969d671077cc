//! A port that opens itself again after its cable came loose.
//!
//! To its user the port falls silent and goes on later; what is written meanwhile is lost, as on any
//! loose cable. The session above sends again what matters, and says when it has waited too long.
//! A USB device is known again by what it says of itself, under whatever name it comes back; what
//! has come in its place is left alone.

use super::is_nothing_yet;
use super::port::{self, PortError, Wire};
use super::usb::UsbIdentity;
use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// A port that is gone is tried again this often: a small part of the second in which a robot is to
/// be back, and rare enough to cost nothing.
const RETRY: Duration = Duration::from_millis(20);

/// So many connections that are closed without a word are no accident.
const MOST_REFUSALS: u32 = 3;

/// A way to a robot that survives unplugging.
#[derive(Debug)]
pub struct Reopening {
    name: String,
    identity: Option<UsbIdentity>,
    wire: Option<Wire>,
    tried: Instant,
    /// Whether anything was ever read, and how often the port was gone.
    read: bool,
    gone: u32,
}

impl Reopening {
    /// Opens a port as [`port::open`] does, and the same device again whenever it fails.
    ///
    /// # Errors
    /// [`PortError`] if it cannot be opened the first time.
    pub fn open(name: &str) -> Result<Self, PortError> {
        let wire = port::open(name)?;
        // Another robot that came meanwhile is no reason to give up a port that is open.
        let name = port::resolve(name).unwrap_or_else(|_| name.to_owned());
        let identity = UsbIdentity::of(&name, &port::list().unwrap_or_default());
        Ok(Self { name, identity, wire: Some(wire), tried: Instant::now(), read: false, gone: 0 })
    }

    /// Whether the port is open as far as is known.
    pub fn is_open(&self) -> bool {
        self.wire.is_some()
    }

    /// Whether whoever is there opens, and closes again without a word: it serves somebody else.
    pub fn is_turned_away(&self) -> bool {
        !self.read && self.gone > MOST_REFUSALS
    }

    /// Where the device is now, if it is anywhere.
    fn place(&self) -> Option<String> {
        match &self.identity {
            Some(identity) => identity.find(&self.name, &port::list().ok()?),
            None => Some(self.name.clone()),
        }
    }

    /// The open port; tries to open it if it is time.
    fn wire(&mut self) -> Option<&mut Wire> {
        if self.wire.is_none() && self.tried.elapsed() >= RETRY {
            self.tried = Instant::now();
            self.wire = self.place().and_then(|name| port::open(&name).ok());
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
            Ok(length) => {
                self.read = true;
                return Ok(length);
            }
            Err(error) if is_nothing_yet(&error) => return Err(error),
            Err(_) => self.wire = None,
        }
        self.gone = self.gone.saturating_add(1);
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
