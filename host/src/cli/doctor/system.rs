//! What the system has and allows.

use super::Check;
use crate::cli::port_rights;
use std::path::{Path, PathBuf};

/// Whether this user may open a serial port.
pub(super) fn access(port: &str) -> Check {
    match port_rights::refused(port) {
        None => Check::ready("robot", format!("{port} may be opened")),
        Some(advice) => {
            Check::fix("robot", format!("{port} may not be opened by this user"), advice)
        }
    }
}

/// A service of Linux that talks to every new serial port, in case it is a modem.
pub(super) fn serial_grabber() -> Option<Check> {
    let runs = std::fs::read_dir("/proc").ok()?.flatten().any(|process| {
        let name = std::fs::read_to_string(process.path().join("comm"));
        name.is_ok_and(|name| name.trim() == "ModemManager")
    });
    let advice = "it holds a new port for some seconds; if a robot is busy just after it was plugged in, wait, or: sudo systemctl disable --now ModemManager";
    runs.then(|| Check::note("modems", "ModemManager runs", advice))
}

/// Whether `wmr serve` can open its page by itself.
pub(super) fn browser() -> Check {
    if cfg!(any(windows, target_os = "macos")) {
        return Check::ready("browser", "the page opens by itself");
    }
    let has_display =
        ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    let advice =
        "wmr serve prints its address: open it by hand; from another computer: wmr serve --lan";
    match (has_display, program("xdg-open")) {
        (false, _) => Check::note("browser", "no display here", advice),
        (true, None) => Check::note("browser", "no xdg-open here", advice),
        (true, Some(_)) => Check::ready("browser", "the page opens by itself"),
    }
}

/// Whether `--port elf:FILE` can run.
pub(super) fn emulator() -> Check {
    match program("node").or_else(|| program("node.exe")) {
        Some(path) => Check::ready("emulator", format!("{} for --port elf:FILE", path.display())),
        None => Check::note(
            "emulator",
            "no Node.js",
            "only --port elf:FILE needs it, version 18 or newer",
        ),
    }
}

/// Where a program is that a shell would find.
fn program(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|file| Path::is_file(file))
}
