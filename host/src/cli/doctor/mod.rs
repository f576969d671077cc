//! `wmr doctor`: what is ready on this computer, what is missing, and what to do about it.

mod system;

use super::error::CliError;
use super::output::Output;
use super::resume::state_folder;
use super::settings::{Settings, user_file};
use std::path::Path;
use wmr::document::{CheckDocument, DoctorDocument, SettingDocument};
use wmr::link::port;

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Ready,
    /// Nothing is wrong, but somebody may want to know.
    Note,
    /// Something will not work.
    Fix,
}

/// What was looked at, what was found, and what to do.
#[derive(Clone, Debug, PartialEq)]
struct Check {
    name: &'static str,
    verdict: Verdict,
    found: String,
    advice: Option<String>,
}

impl Check {
    fn ready(name: &'static str, found: impl Into<String>) -> Self {
        Self { name, verdict: Verdict::Ready, found: found.into(), advice: None }
    }

    fn note(name: &'static str, found: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { name, verdict: Verdict::Note, found: found.into(), advice: Some(advice.into()) }
    }

    fn fix(name: &'static str, found: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { name, verdict: Verdict::Fix, found: found.into(), advice: Some(advice.into()) }
    }

    fn document(&self) -> CheckDocument {
        let verdict = match self.verdict {
            Verdict::Ready => "ready",
            Verdict::Note => "note",
            Verdict::Fix => "fix",
        };
        CheckDocument {
            name: self.name.to_owned(),
            verdict: verdict.to_owned(),
            found: self.found.clone(),
            advice: self.advice.clone(),
        }
    }

    fn text(&self) -> String {
        let mark = match self.verdict {
            Verdict::Ready => "ok  ",
            Verdict::Note => "note",
            Verdict::Fix => "FIX ",
        };
        let advice =
            self.advice.as_ref().map_or(String::new(), |advice| format!("     -> {advice}\n"));
        format!("{mark} {:9} {}\n{advice}", self.name, self.found)
    }
}

/// `wmr doctor`, with what the files of settings say or why they say nothing.
pub(crate) fn run(settings: &Result<Settings, CliError>, output: Output) -> Result<(), CliError> {
    let mut checks = vec![version()];
    checks.extend(ports());
    checks.extend(system::serial_grabber());
    checks.push(system::browser());
    checks.push(writable("here", Path::new(".")));
    checks.extend(state_folder().map(|folder| writable("memory", &folder)));
    checks.push(system::emulator());
    checks.push(settings_check(settings));
    let in_effect = settings.as_ref().map(Settings::in_effect).unwrap_or_default();
    let to_fix = checks.iter().filter(|check| check.verdict == Verdict::Fix).count();
    let set = in_effect.iter().map(|(name, value, source)| SettingDocument {
        name: (*name).to_owned(),
        value: value.clone(),
        source: source.clone(),
    });
    let set: Vec<SettingDocument> = set.collect();
    let documents: Vec<CheckDocument> = checks.iter().map(Check::document).collect();
    let document = DoctorDocument { checks: documents, settings: set, to_fix };
    let mut text: String = checks.iter().map(Check::text).collect();
    for (name, value, source) in &in_effect {
        text += &format!("     {name} = {value}  ({source})\n");
    }
    text += &format!("{} checked, {to_fix} to fix", checks.len());
    output.result(&document, &text)
}

fn version() -> Check {
    let (version, protocol) = (env!("CARGO_PKG_VERSION"), wmr::protocol::message::PROTOCOL_VERSION);
    let (system, machine) = (std::env::consts::OS, std::env::consts::ARCH);
    Check::ready("wmr", format!("{version}, protocol {protocol}, {system} {machine}"))
}

/// Which robots are there, and whether this user may open their ports.
fn ports() -> Vec<Check> {
    let ports = match port::list() {
        Ok(ports) => ports,
        Err(error) => {
            return vec![Check::fix(
                "ports",
                error.to_string(),
                "use --port sim, or name the device",
            )];
        }
    };
    let robots: Vec<&str> = ports
        .iter()
        .filter(|port| port::is_robot(port))
        .map(|port| port.port_name.as_str())
        .collect();
    let mut checks: Vec<Check> = robots.iter().map(|name| system::access(name)).collect();
    if port::boot_loader_waits() {
        let found = "a Pico waits in its boot loader";
        checks.push(Check::note("robot", found, "wmr flash target/firmware/pico.uf2"));
    } else if robots.is_empty() {
        let found = format!("no robot on USB ({} serial ports looked at)", ports.len());
        checks.push(Check::note(
            "robot",
            found,
            "plug one in with a data cable; without one: --port sim",
        ));
    }
    checks
}

/// Whether a file can be made in a folder, or in the nearest one above it that there is.
fn writable(name: &'static str, folder: &Path) -> Check {
    let there = folder.ancestors().find(|folder| folder.is_dir()).unwrap_or(Path::new("."));
    let file = there.join(format!(".wmr-doctor-{}", std::process::id()));
    let shown = folder.display();
    let written = std::fs::write(&file, b"");
    // Not there is as good as removed.
    let _ = std::fs::remove_file(&file);
    match (written, name) {
        (Ok(()), _) => Check::ready(name, format!("{shown} can be written to")),
        (Err(error), "memory") => Check::fix(
            name,
            format!("{shown}: {error}"),
            "drives cannot be resumed and wmr stop cannot reach them; set XDG_STATE_HOME to a folder of yours",
        ),
        (Err(error), _) => {
            Check::note(name, format!("{shown}: {error}"), "write elsewhere: --out, --log, -o")
        }
    }
}

fn settings_check(settings: &Result<Settings, CliError>) -> Check {
    match settings {
        Err(error) => Check::fix("settings", &error.message, &error.help),
        Ok(settings) if settings.files.is_empty() => {
            let user =
                user_file().map_or(String::new(), |file| format!(", nor {}", file.display()));
            Check::ready("settings", format!("no wmr.toml from here upwards{user}"))
        }
        Ok(settings) => {
            let names: Vec<String> =
                settings.files.iter().map(|file| file.display().to_string()).collect();
            Check::ready("settings", names.join(", then "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_there_yet_is_judged_by_the_one_above() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(writable("here", &folder.path().join("a/b")).verdict, Verdict::Ready);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
    }

    #[test]
    fn advice_stands_below_what_was_found() {
        let text = Check::fix("robot", "may not be opened", "do this").text();
        assert_eq!(text, "FIX  robot     may not be opened\n     -> do this\n");
    }
}
