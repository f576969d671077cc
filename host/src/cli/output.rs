//! Data to standard output, talk to standard error.

use super::error::{CliError, Exit};
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Whether standard output has its document: there is never a second one.
static HAS_DOCUMENT: AtomicBool = AtomicBool::new(false);

/// How often a sign of life changes.
const SPIN: Duration = Duration::from_millis(120);

/// How a command speaks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    /// Exactly one JSON document on standard output, and no text for people there.
    pub(crate) json: bool,
    /// No talk.
    pub(crate) quiet: bool,
}

impl Output {
    /// Prints a command's result: `document` for programs, or `text` for people.
    ///
    /// # Errors
    /// If standard output cannot be written to. A reader that has gone away, as after `| head`, is no
    /// error of ours.
    pub(crate) fn result(
        self,
        document: &impl serde::Serialize,
        text: &str,
    ) -> Result<(), CliError> {
        let line = if self.json { to_json(document) } else { text.trim_end().to_owned() };
        print_line(&line).map_err(|error| unwritable(&error))
    }

    /// Says something to the person at the terminal.
    pub(crate) fn say(self, text: &str) {
        if !self.quiet {
            // Nobody reads it: nothing is lost.
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// Asks the person at the terminal, who must answer even if there is to be no talk.
    pub(crate) fn ask(self, text: &str) {
        let _ = write!(io::stderr(), "{text} ");
    }

    /// Prints one line of many on standard output; false once nobody reads them any more.
    ///
    /// # Errors
    /// As for [`result`](Self::result).
    pub(crate) fn line(self, text: &str) -> Result<bool, CliError> {
        HAS_DOCUMENT.store(true, Ordering::Relaxed);
        let mut out = io::stdout().lock();
        match writeln!(out, "{text}").and_then(|()| out.flush()) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
            Err(error) => Err(unwritable(&error)),
        }
    }

    /// A line on standard output that is kept up to date, if somebody sees it.
    pub(crate) fn live_line(self) -> LiveLine {
        LiveLine { shown: !self.json && io::stdout().is_terminal(), used: false }
    }

    /// Prints an error.
    pub(crate) fn error(self, error: &CliError) {
        if self.json && !error.after_result && !HAS_DOCUMENT.load(Ordering::Relaxed) {
            // There is no other place for it.
            let _ = print_line(&to_json(&error.document()));
        } else {
            let _ = writeln!(io::stderr(), "{}", error.text());
        }
    }

    /// A bar of `length` steps, hidden where nobody would see it move.
    pub(crate) fn progress(self, length: u64) -> indicatif::ProgressBar {
        if self.quiet || self.json || !io::stderr().is_terminal() {
            return indicatif::ProgressBar::hidden();
        }
        indicatif::ProgressBar::new(length)
    }

    /// A sign that something goes on of which nobody knows how long it takes.
    pub(crate) fn waiting(self, what: &str) -> indicatif::ProgressBar {
        if self.quiet || self.json || !io::stderr().is_terminal() {
            return indicatif::ProgressBar::hidden();
        }
        let bar = indicatif::ProgressBar::new_spinner().with_message(what.to_owned());
        bar.enable_steady_tick(SPIN);
        bar
    }
}

/// A line of the terminal that is written over again and again.
#[derive(Debug)]
pub(crate) struct LiveLine {
    shown: bool,
    used: bool,
}

impl LiveLine {
    /// Whether standard output is a terminal.
    pub(crate) fn is_shown(&self) -> bool {
        self.shown
    }

    /// Writes over what was there.
    pub(crate) fn show(&mut self, text: &str) {
        self.used = true;
        let mut out = io::stdout().lock();
        // Where the terminal is gone, nobody misses the line.
        let _ = write!(out, "\r{text}\x1b[K").and_then(|()| out.flush());
    }
}

impl Drop for LiveLine {
    fn drop(&mut self) {
        if self.used {
            let _ = writeln!(io::stdout());
        }
    }
}

fn unwritable(error: &io::Error) -> CliError {
    let message = format!("cannot write to standard output: {error}");
    CliError::new(Exit::File, "output", message, "make room, or write to another place")
}

fn to_json(document: &impl serde::Serialize) -> String {
    serde_json::to_string(document).unwrap_or_else(|error| {
        format!(r#"{{"error":{{"code":"bug","message":"{error}","help":"please report it"}}}}"#)
    })
}

fn print_line(line: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    HAS_DOCUMENT.store(true, Ordering::Relaxed);
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}
