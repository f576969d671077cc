//! A pseudo-terminal: to any serial client the simulated robot looks like a device file.
//!
//! Only on Unix. Elsewhere, and for clients on other computers, there is [`tcp`](crate::tcp).

use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use rustix::io::{FdFlags, fcntl_setfd};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// The robot's end of a pseudo-terminal.
#[derive(Debug)]
pub struct Pty {
    end: File,
    device: PathBuf,
    link: Option<PathBuf>,
}

impl Pty {
    /// Opens a pseudo-terminal; if `link` is given, a symbolic link of that name leads to its device
    /// for as long as this lives.
    ///
    /// # Errors
    /// What the system says; `AlreadyExists` if `link` is the name of something else than a link.
    pub fn open(link: Option<&Path>) -> io::Result<Self> {
        let end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&end)?;
        unlockpt(&end)?;
        let mut modes = tcgetattr(&end)?;
        modes.make_raw();
        tcsetattr(&end, OptionalActions::Now, &modes)?;
        // A child process that inherited this end would keep the terminal alive.
        fcntl_setfd(&end, FdFlags::CLOEXEC)?;
        fcntl_setfl(&end, fcntl_getfl(&end)? | OFlags::NONBLOCK)?;
        let name = ptsname(&end, Vec::new())?.into_string().map_err(|_| ErrorKind::InvalidData)?;
        let device = PathBuf::from(name);
        if let Some(link) = link {
            if link.is_symlink() {
                std::fs::remove_file(link)?;
            }
            std::os::unix::fs::symlink(&device, link)?;
        }
        Ok(Self { end: File::from(end), device, link: link.map(Path::to_owned) })
    }

    /// The device file that clients open.
    pub fn device(&self) -> &Path {
        &self.device
    }
}

impl Read for Pty {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.end.read(buffer).map_err(nobody_is_nothing)
    }
}

impl Write for Pty {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.end.write(buffer).map_err(nobody_is_nothing)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        // The next simulation may have taken the name over: then the link leads to its device.
        let ours = |link: &&PathBuf| std::fs::read_link(link).is_ok_and(|to| to == self.device);
        if let Some(link) = self.link.as_ref().filter(ours) {
            // A link that somebody else has removed meanwhile is no loss.
            let _ = std::fs::remove_file(link);
        }
    }
}

/// While no client has the device open, the system reports an input/output error.
fn nobody_is_nothing(error: io::Error) -> io::Error {
    if error.raw_os_error() == Some(rustix::io::Errno::IO.raw_os_error()) {
        ErrorKind::WouldBlock.into()
    } else {
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_another_has_taken_over_stays() {
        let directory = tempfile::tempdir().unwrap();
        let link = directory.path().join("robot");
        let first = Pty::open(Some(&link)).unwrap();
        let second = Pty::open(Some(&link)).unwrap();
        drop(first);
        assert_eq!(std::fs::read_link(&link).unwrap(), second.device());
        drop(second);
        assert!(!link.is_symlink());
    }

    #[test]
    fn every_byte_passes_both_ways_unchanged() {
        let directory = tempfile::tempdir().unwrap();
        let link = directory.path().join("robot");
        let mut pty = Pty::open(Some(&link)).unwrap();
        assert_eq!(pty.read(&mut [0; 8]).unwrap_err().kind(), ErrorKind::WouldBlock);
        let mut client = File::options().read(true).write(true).open(&link).unwrap();
        let all: Vec<u8> = (0..=255).collect();
        client.write_all(&all).unwrap();
        let mut received = vec![0; 256];
        pty.read_exact(&mut received).unwrap();
        assert_eq!(received, all);
        pty.write_all(&all).unwrap();
        client.read_exact(&mut received).unwrap();
        assert_eq!(received, all);
        drop(pty);
        assert!(!link.is_symlink());
    }
}
