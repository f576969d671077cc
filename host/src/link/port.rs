//! Serial ports and sockets that a robot may be behind, and errors that say what to do.
//!
//! Nothing is ever written to a device that was not named, or that does not say over USB that it is
//! a robot of ours.

use super::usb;
use serialport::{SerialPort, SerialPortInfo, SerialPortType};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::time::Duration;

/// The product name that the robot gives over USB.
pub const USB_PRODUCT: &str = "wmr base";

/// Why no port was opened.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PortError {
    /// Nothing of that name.
    #[error("there is no port {name}")]
    #[diagnostic(help("{}", instead_of(name)))]
    Missing {
        /// What was asked for.
        name: String,
    },
    /// A computer that was reached, but no program on it.
    #[error("nobody listens at {name}")]
    #[diagnostic(help("start what shall listen there, such as wmr sim --tcp {}", name.trim_start_matches("tcp://")))]
    NobodyListens {
        /// What was asked for.
        name: String,
    },
    /// Another program has it.
    #[error("{name} is open in another program")]
    #[diagnostic(help(
        "close the other program (a serial monitor? a second wmr? press Ctrl-C there); to stop the robot at once pull its cable: it stops within 0.3 s of silence"
    ))]
    Busy {
        /// What was asked for.
        name: String,
    },
    /// The user may not open it.
    #[error("{name} may not be opened by this user")]
    #[diagnostic(help(
        "join the group that the device belongs to, which on most systems is dialout, then log out and in"
    ))]
    Denied {
        /// What was asked for.
        name: String,
    },
    /// No robot, or more than one, on USB.
    #[error("{} found on USB ({} looked at)", counted(*.found, "robot"), counted(*.looked_at, "serial port"))]
    #[diagnostic(help("{}", choose(*.found)))]
    NotOne {
        /// Robots found.
        found: usize,
        /// Ports looked at.
        looked_at: usize,
    },
    /// The robot's board waits for a firmware instead of running one.
    #[error("{name} is not there, but a Pico waits in its boot loader")]
    #[diagnostic(help(
        "plug it in again without holding BOOTSEL, or give it its firmware: wmr flash target/firmware/pico.uf2"
    ))]
    BootLoader {
        /// What was asked for.
        name: String,
    },
    /// Something else.
    #[error("{name} cannot be opened: {cause}")]
    #[diagnostic(help("wmr ports lists what is there"))]
    Other {
        /// What was asked for.
        name: String,
        /// What the system says.
        cause: String,
    },
}

/// What to give in place of a port that is not there.
fn instead_of(name: &str) -> String {
    match name.to_lowercase().as_str() {
        known @ ("sim" | "auto") => {
            format!("did you mean --port {known}? wmr ports lists what is there")
        }
        _ => "wmr ports lists what is there; without a robot: --port sim".to_owned(),
    }
}

fn choose(found: usize) -> &'static str {
    match found {
        0 => "plug the robot in with a data cable, or try without one: --port sim",
        _ => "choose one with --port; wmr ports lists them",
    }
}

fn counted(number: usize, what: &str) -> String {
    match number {
        0 => format!("no {what}"),
        1 => format!("1 {what}"),
        number => format!("{number} {what}s"),
    }
}

/// The speed of the robot's UART; USB and pseudo-terminals ignore it.
const BAUD: u32 = 115_200;
/// The speed that asks a board for its boot loader.
const TOUCH_BAUD: u32 = 1200;
/// A read waits this long for a first byte.
const READ_TIMEOUT: Duration = Duration::from_millis(1);
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
/// A write waits this long for a peer that does not read; the program's timers wait with it.
const WRITE_TIMEOUT: Duration = Duration::from_millis(20);

/// An open way to a robot.
#[derive(Debug)]
pub enum Wire {
    /// A serial port, real or pseudo.
    Serial(Box<dyn SerialPort>),
    /// A socket.
    Tcp(TcpStream),
}

/// Opens `auto`, `tcp://HOST:PORT` or the name of a serial device.
///
/// # Errors
/// [`PortError`] with the reason.
pub fn open(name: &str) -> Result<Wire, PortError> {
    match name.strip_prefix("tcp://") {
        Some(address) => open_tcp(address).map(Wire::Tcp).map_err(|error| explain(name, &error)),
        None => resolve(name)
            .and_then(|device| open_serial(&device))
            .map(Wire::Serial)
            .map_err(|error| or_boot_loader(error, name, usb::boot_loader_waits)),
    }
}

/// The device that `auto` means now; any other name means itself.
///
/// # Errors
/// [`PortError::NotOne`] if `auto` may mean none or several.
pub fn resolve(name: &str) -> Result<String, PortError> {
    if name != "auto" {
        return Ok(name.to_owned());
    }
    let ports = list()?;
    only_robot(&robots(&ports), ports.len())
}

/// A robot that is missing may be there in another guise.
fn or_boot_loader(error: PortError, name: &str, waits: impl Fn() -> bool) -> PortError {
    match error {
        PortError::Missing { .. } | PortError::NotOne { found: 0, .. } if waits() => {
            let name = if name == "auto" { "the robot" } else { name };
            PortError::BootLoader { name: name.to_owned() }
        }
        error => error,
    }
}

/// All serial ports of this computer.
///
/// # Errors
/// [`PortError::Other`] if the system does not tell.
pub fn list() -> Result<Vec<SerialPortInfo>, PortError> {
    serialport::available_ports().map_err(|error| PortError::Other {
        name: "the list of ports".into(),
        cause: error.to_string(),
    })
}

/// Whether a port says over USB that it is a robot of ours.
pub fn is_robot(port: &SerialPortInfo) -> bool {
    matches!(&port.port_type, SerialPortType::UsbPort(usb)
        if usb.product.as_deref().is_some_and(|product| product.replace('_', " ") == USB_PRODUCT))
}

fn robots(ports: &[SerialPortInfo]) -> Vec<String> {
    ports.iter().filter(|port| is_robot(port)).map(|port| port.port_name.clone()).collect()
}

fn only_robot(robots: &[String], looked_at: usize) -> Result<String, PortError> {
    match robots {
        [only] => Ok(only.clone()),
        _ => Err(PortError::NotOne { found: robots.len(), looked_at }),
    }
}

fn open_serial(name: &str) -> Result<Box<dyn SerialPort>, PortError> {
    let port = serialport::new(name, BAUD).timeout(READ_TIMEOUT).open();
    port.map_err(|error| explain_serial(name, error, Path::new(name).exists()))
}

/// Opens a serial port at 1200 baud and closes it again: for a robot at rest, and for many other boards,
/// the word to go to its boot loader. One that drives passes it over.
///
/// # Errors
/// [`PortError`] with the reason if the port cannot be opened.
pub fn touch(name: &str) -> Result<(), PortError> {
    let port = serialport::new(name, TOUCH_BAUD).timeout(READ_TIMEOUT).open();
    port.map(drop).map_err(|error| explain_serial(name, error, Path::new(name).exists()))
}

/// Whether a Pico waits in its boot loader on USB; only Linux tells.
pub fn boot_loader_waits() -> bool {
    usb::boot_loader_waits()
}

fn explain_serial(name: &str, error: serialport::Error, exists: bool) -> PortError {
    match error.kind() {
        // The crate says NoDevice both for a missing device and for one that is locked.
        serialport::ErrorKind::NoDevice if exists => PortError::Busy { name: name.to_owned() },
        serialport::ErrorKind::NoDevice => PortError::Missing { name: name.to_owned() },
        serialport::ErrorKind::Io(kind) => explain(name, &io::Error::new(kind, error.description)),
        _ => PortError::Other { name: name.to_owned(), cause: error.description },
    }
}

fn open_tcp(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::from(ErrorKind::NotFound);
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ_TIMEOUT))?;
                stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

fn explain(name: &str, error: &io::Error) -> PortError {
    let name = name.to_owned();
    match error.kind() {
        ErrorKind::NotFound => PortError::Missing { name },
        ErrorKind::ConnectionRefused => PortError::NobodyListens { name },
        ErrorKind::PermissionDenied => PortError::Denied { name },
        ErrorKind::ResourceBusy => PortError::Busy { name },
        _ => PortError::Other { name, cause: error.to_string() },
    }
}

impl Read for Wire {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Serial(port) => port.read(buffer),
            // A socket says "closed" by reading nothing; for a port that is an error.
            Self::Tcp(stream) => match stream.read(buffer)? {
                0 => Err(ErrorKind::ConnectionAborted.into()),
                length => Ok(length),
            },
        }
    }
}

impl Write for Wire {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        match self {
            Self::Serial(port) => port.write(buffer),
            Self::Tcp(stream) => stream.write(buffer),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Serial(port) => port.flush(),
            Self::Tcp(stream) => stream.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_that_is_not_there_is_missing() {
        assert!(matches!(open("/dev/no-such-port"), Err(PortError::Missing { .. })));
    }

    #[test]
    fn a_file_that_is_no_terminal_is_not_opened() {
        assert!(open("/dev/null").is_err());
    }

    #[test]
    fn only_one_robot_is_chosen_by_itself() {
        assert!(only_robot(&["a".into()], 3).is_ok());
        assert!(matches!(only_robot(&[], 1), Err(PortError::NotOne { found: 0, looked_at: 1 })));
        assert!(only_robot(&["a".into(), "b".into()], 2).is_err());
    }

    #[test]
    fn what_the_system_says_is_told_apart() {
        use serialport::ErrorKind::{Io, NoDevice};
        let explained = |kind, exists| {
            explain_serial("tty", serialport::Error::new(kind, "as the system says"), exists)
        };
        assert!(matches!(explained(NoDevice, true), PortError::Busy { .. }));
        assert!(matches!(explained(NoDevice, false), PortError::Missing { .. }));
        assert!(matches!(explained(Io(ErrorKind::ResourceBusy), true), PortError::Busy { .. }));
        assert!(matches!(
            explained(Io(ErrorKind::PermissionDenied), true),
            PortError::Denied { .. }
        ));
        assert!(matches!(explained(Io(ErrorKind::NotFound), false), PortError::Missing { .. }));
        assert!(matches!(explained(Io(ErrorKind::InvalidInput), true), PortError::Other { .. }));
    }

    #[test]
    fn a_missing_robot_may_wait_in_its_boot_loader() {
        let missing = || PortError::Missing { name: "tty".into() };
        let none = || PortError::NotOne { found: 0, looked_at: 3 };
        for (error, name) in [(missing(), "tty"), (none(), "auto")] {
            let told = or_boot_loader(error, name, || true);
            assert!(matches!(told, PortError::BootLoader { .. }), "{told}");
        }
        assert!(matches!(or_boot_loader(missing(), "tty", || false), PortError::Missing { .. }));
        let busy = PortError::Busy { name: "tty".into() };
        assert!(matches!(or_boot_loader(busy, "tty", || true), PortError::Busy { .. }));
    }

    #[test]
    fn an_address_at_which_nobody_listens_is_told() {
        let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        assert!(matches!(open(&format!("tcp://{free}")), Err(PortError::NobodyListens { .. })));
    }
}
