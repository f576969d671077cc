//! The socket on Unix.

use super::{ANSWER_TIMEOUT, Answer, RESTS, STOP, socket};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The one that is open; a program has one port at a time.
static OPEN: Mutex<Option<Desk>> = Mutex::new(None);

/// Keeps the desk open for as long as the port is.
#[derive(Debug)]
pub(crate) struct StopDesk;

impl StopDesk {
    /// Opens one for the port of that name. A port is not refused because that fails.
    pub(crate) fn open(port: &str) -> Self {
        *desk() = socket(port).and_then(Desk::at);
        Self
    }
}

impl Drop for StopDesk {
    fn drop(&mut self) {
        *desk() = None;
    }
}

/// Whether somebody has asked and was not told yet.
pub(crate) fn asked() -> bool {
    desk().as_mut().is_some_and(Desk::asked)
}

/// Tells those who asked that the robot rests.
pub(crate) fn confirm() {
    desk().iter_mut().for_each(Desk::confirm);
}

fn desk() -> MutexGuard<'static, Option<Desk>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where others may ask this program to stop its robot.
#[derive(Debug)]
struct Desk {
    listener: UnixListener,
    path: PathBuf,
    /// Who has connected and not yet said what it wants.
    callers: Vec<UnixStream>,
    asking: Vec<UnixStream>,
}

impl Desk {
    fn at(path: PathBuf) -> Option<Self> {
        std::fs::create_dir_all(path.parent()?).ok()?;
        if UnixStream::connect(&path).is_err() {
            // What a killed program has left behind.
            let _ = std::fs::remove_file(&path);
        }
        let listener = UnixListener::bind(&path).ok()?;
        listener.set_nonblocking(true).ok()?;
        Some(Self { listener, path, callers: Vec::new(), asking: Vec::new() })
    }

    fn asked(&mut self) -> bool {
        let caller = self.listener.accept().ok().map(|(stream, _)| stream);
        self.callers.extend(caller.filter(|stream| stream.set_nonblocking(true).is_ok()));
        for mut caller in std::mem::take(&mut self.callers) {
            match caller.read(&mut [0; STOP.len()]) {
                // Only looked whether anybody is there.
                Ok(0) => {}
                Ok(_) => self.asking.push(caller),
                Err(error) if error.kind() == ErrorKind::WouldBlock => self.callers.push(caller),
                Err(_) => {}
            }
        }
        !self.asking.is_empty()
    }

    fn confirm(&mut self) {
        for mut stream in self.asking.drain(..) {
            // Who does not listen any more need not know.
            let _ = writeln!(stream, "{RESTS}");
        }
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        // Not there is as good as removed.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Asks the program that has the robot behind `port` to stop it.
pub(crate) fn ask(port: &str) -> Answer {
    let Some(mut stream) = socket(port).and_then(|path| UnixStream::connect(path).ok()) else {
        return Answer::Nobody;
    };
    let mut text = String::new();
    let read = stream
        .set_read_timeout(Some(ANSWER_TIMEOUT))
        .and_then(|()| stream.write_all(STOP))
        .and_then(|()| stream.read_to_string(&mut text));
    match read {
        Ok(_) if text.trim() == RESTS => Answer::Stopped,
        _ => Answer::Unconfirmed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_heard_answered_and_its_socket_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("port.sock");
        // Left behind by a program that was killed.
        drop(UnixListener::bind(&path).unwrap());
        let mut desk = Desk::at(path.clone()).unwrap();
        assert!(!desk.asked());
        drop(UnixStream::connect(&path).unwrap());
        let mut stream = UnixStream::connect(&path).unwrap();
        assert!(!desk.asked() && !desk.asked(), "nobody has said anything");
        stream.write_all(STOP).unwrap();
        while !desk.asked() {}
        desk.confirm();
        assert!(!desk.asked(), "it was told");
        drop(desk);
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        assert_eq!(text, "stopped\n");
        assert!(!path.exists());
    }
}
