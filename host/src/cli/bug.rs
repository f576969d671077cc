//! A panic is a bug of this program, and is told as one: exit code 1, one document, a request to report.

use super::error::{CliError, Exit};
use super::output::Output;
use std::panic::{self, PanicHookInfo, UnwindSafe};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs the program; a panic anywhere in it, on any thread, ends as a bug.
pub(crate) fn guard(json: bool, program: impl FnOnce() -> ExitCode + UnwindSafe) -> ExitCode {
    // A thread that fails may make the one that waits for it fail too: the first says why.
    let told = AtomicBool::new(false);
    panic::set_hook(Box::new(move |panic| {
        if !told.swap(true, Ordering::Relaxed) {
            Output { json, quiet: true }.error(&bug(panic));
        }
    }));
    panic::catch_unwind(program).unwrap_or(ExitCode::from(Exit::Bug as u8))
}

fn bug(panic: &PanicHookInfo<'_>) -> CliError {
    let why = panic.payload_as_str().unwrap_or("no reason given");
    let place = panic.location().map_or(String::new(), |place| format!(" ({place})"));
    CliError::new(
        Exit::Bug,
        "bug",
        format!("this program has failed: {why}{place}; a robot that it drove stops by itself"),
        concat!(
            "please report it with the command and its files; this is wmr ",
            env!("CARGO_PKG_VERSION")
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    /// Set in the process that fails: the hook is a whole process's, so the test starts itself in another.
    const FAILS: &str = "WMR_TEST_FAILS";

    /// A program whose worker fails, and which then fails itself.
    fn fail() -> ! {
        let code = guard(true, || {
            let worker = std::thread::spawn(|| panic!("box {} of 2", 3));
            assert!(worker.join().is_ok(), "its worker failed");
            ExitCode::SUCCESS
        });
        std::process::exit(i32::from(code != ExitCode::from(1)) + 1);
    }

    #[test]
    fn a_panic_is_one_document_and_exit_code_1() {
        if std::env::var_os(FAILS).is_some() {
            fail();
        }
        let this = "cli::bug::tests::a_panic_is_one_document_and_exit_code_1";
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "--nocapture", this])
            .env(FAILS, "1")
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        // The harness of the tests writes lines of its own around it.
        let found =
            text.match_indices(r#"{"error":"#).map(|(at, _)| &text[at..]).collect::<Vec<_>>();
        assert_eq!(found.len(), 1, "{text}");
        let line = found[0].lines().next().unwrap();
        let document: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!(document["error"]["code"], "bug");
        assert!(document["error"]["message"].as_str().unwrap().contains("box 3 of 2"), "{line}");
        assert!(document["error"]["help"].as_str().unwrap().contains("report"), "{line}");
    }
}
