//! The socket on Unix.

use super::{ANSWER_TIMEOUT, Answer, RESTS, socket};
use std::cell::RefCell;
use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;

/// Where others may ask this program to stop its robot.
#[derive(Debug)]
pub(crate) struct StopDesk {
    listener: Option<(UnixListener, PathBuf)>,
    asking: RefCell<Vec<UnixStream>>,
}

impl StopDesk {
    /// Opens one for the port of that name. A drive is not refused because that fails.
    pub(crate) fn open(port: &str) -> Self {
        Self { listener: socket(port).and_then(listen), asking: RefCell::default() }
    }

    /// Whether somebody has asked.
    pub(crate) fn asked(&self) -> bool {
        let mut asking = self.asking.borrow_mut();
        if let Some((listener, _)) = &self.listener
            && let Ok((stream, _)) = listener.accept()
        {
            asking.push(stream);
        }
        !asking.is_empty()
    }

    /// Tells those who asked that the robot rests.
    pub(crate) fn confirm(&self) {
        for stream in self.asking.borrow_mut().iter_mut() {
            // Who does not listen any more need not know.
            let _ = writeln!(stream, "{RESTS}");
        }
    }
}

impl Drop for StopDesk {
    fn drop(&mut self) {
        if let Some((_, path)) = &self.listener {
            // Not there is as good as removed.
            let _ = std::fs::remove_file(path);
        }
    }
}

fn listen(path: PathBuf) -> Option<(UnixListener, PathBuf)> {
    std::fs::create_dir_all(path.parent()?).ok()?;
    if UnixStream::connect(&path).is_err() {
        // What a killed program has left behind.
        let _ = std::fs::remove_file(&path);
    }
    let listener = UnixListener::bind(&path).ok()?;
    listener.set_nonblocking(true).ok()?;
    Some((listener, path))
}

/// Asks the program that drives the robot behind `port` to stop it.
pub(crate) fn ask(port: &str) -> Answer {
    let Some(mut stream) = socket(port).and_then(|path| UnixStream::connect(path).ok()) else {
        return Answer::Nobody;
    };
    let mut text = String::new();
    let read = stream
        .set_read_timeout(Some(ANSWER_TIMEOUT))
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
        let desk = StopDesk { listener: listen(path.clone()), asking: RefCell::default() };
        assert!(!desk.asked());
        let mut stream = UnixStream::connect(&path).unwrap();
        while !desk.asked() {}
        desk.confirm();
        drop(desk);
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        assert_eq!(text, "stopped\n");
        assert!(!path.exists());
    }
}
