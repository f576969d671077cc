//! `wmr flash`: a firmware onto a Pico, with nothing but a USB cable.
//!
//! ```text
//! file ─► whole, and for which chip? ─► boot drive there? ─no─► robot told to go there ─► copied ─► taken
//! ```
//! The boot loader of a Pico shows itself as a drive that holds `INFO_UF2.TXT`; it takes the file that is
//! copied there, and the drive goes away when it starts what it was given.

use super::args::FlashArgs;
use super::error::{CliError, Exit};
use super::input::read_bytes;
use super::mission::{catch_interrupts, interrupted, interrupted_error};
use super::output::Output;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use wmr::document::FlashDocument;
use wmr::link::port;
use wmr::uf2::{Family, Image, Uf2Error, family_of};

/// What a boot drive holds, and tells of itself in.
const INFO: &str = "INFO_UF2.TXT";
/// How often is looked for a drive.
const LOOK: Duration = Duration::from_millis(200);
/// A board that has taken its firmware is gone by then.
const TAKEN: Duration = Duration::from_secs(10);

/// `wmr flash`.
pub(crate) fn run(args: &FlashArgs, output: Output) -> Result<(), CliError> {
    catch_interrupts();
    let (bytes, family) = firmware(&args.file)?;
    let drive = drive(args, output)?;
    let board = board(&drive)?;
    if board != family {
        let message = format!(
            "{} is for {}, and {} is {}",
            args.file.display(),
            name(family),
            drive.display(),
            name(board)
        );
        let help = "take pico.uf2 for a Pico, pico2.uf2 for a Pico 2; nothing was written";
        return Err(CliError::new(Exit::File, "flash.other_chip", message, help));
    }
    let place = drive.join("WMR.UF2");
    output.say(&format!("copying {} kB to {}", bytes.len() / 1024, drive.display()));
    copy(&place, &bytes)?;
    taken(&drive, &place)?;
    let document = FlashDocument {
        board: name(family).to_owned(),
        drive: drive.display().to_string(),
        bytes: bytes.len(),
    };
    output.result(&document, "flashed; the board runs it now, and wmr info asks it who it is")
}

/// The bytes to copy and the chip that they are for; an ELF file is packed first.
fn firmware(path: &Path) -> Result<(Vec<u8>, Family), CliError> {
    let bytes = read_bytes(path)?;
    let refused = |error: Uf2Error| CliError::of(Exit::File, "flash.file", &error).in_file(path);
    if bytes.starts_with(b"\x7fELF") {
        let image = Image::from_elf(&bytes).map_err(refused)?;
        return Ok((image.to_uf2(), image.family()));
    }
    let family = family_of(&bytes).map_err(refused)?;
    Ok((bytes, family))
}

/// The boot drive: the one that was named, one that is there, or one that comes when the robot is asked.
fn drive(args: &FlashArgs, output: Output) -> Result<PathBuf, CliError> {
    if let Some(drive) = &args.drive {
        return if drive.join(INFO).is_file() {
            Ok(drive.clone())
        } else {
            Err(no_boot_drive(drive))
        };
    }
    if let Some(drive) = only(&boot_drives())? {
        return Ok(drive);
    }
    if !port::boot_loader_waits() {
        let device = port::resolve(&args.port)?;
        output.say(&format!("asking {device} to go to its boot loader"));
        port::touch(&device)?;
    }
    let bar = output.waiting("waiting for the boot drive");
    let began = Instant::now();
    while began.elapsed() < args.wait {
        if interrupted() {
            return Err(interrupted_error("nothing was written"));
        }
        if let Some(drive) = only(&boot_drives())? {
            return Ok(drive);
        }
        bar.tick();
        std::thread::sleep(LOOK);
    }
    Err(never_came(args.wait))
}

fn no_boot_drive(drive: &Path) -> CliError {
    let message = format!("{} holds no {INFO}, so it is no Pico's boot drive", drive.display());
    let help = "hold BOOTSEL while you plug the Pico in, and name the drive that then appears";
    CliError::new(Exit::Port, "flash.no_drive", message, help)
}

fn never_came(wait: Duration) -> CliError {
    let message = format!("no boot drive appeared within {} s", wait.as_secs());
    let help = if port::boot_loader_waits() {
        "a Pico waits in its boot loader, but nothing mounts its drive: mount it (udisksctl mount -b /dev/disk/by-label/RPI-RP2; a Pico 2: RP2350) and say wmr flash FILE --drive WHERE"
    } else {
        "stop the robot first; or hold BOOTSEL while you plug the Pico in, then wmr flash FILE again"
    };
    CliError::new(Exit::Port, "flash.no_drive", message, help)
}

/// The only boot drive, if there is one: which of two is meant nobody can know.
fn only(drives: &[PathBuf]) -> Result<Option<PathBuf>, CliError> {
    match drives {
        [] => Ok(None),
        [drive] => Ok(Some(drive.clone())),
        several => {
            let names: Vec<String> =
                several.iter().map(|drive| drive.display().to_string()).collect();
            let message =
                format!("{} Picos wait in their boot loaders: {}", several.len(), names.join(", "));
            Err(CliError::new(Exit::Port, "flash.several", message, "choose one with --drive"))
        }
    }
}

/// Where boot drives are mounted.
fn boot_drives() -> Vec<PathBuf> {
    let mounts = fs::read_to_string("/proc/mounts").unwrap_or_default();
    let mut places = mount_points(&mounts);
    if cfg!(target_os = "macos") {
        let volumes = fs::read_dir("/Volumes").into_iter().flatten().flatten();
        places.extend(volumes.map(|volume| volume.path()));
    }
    if cfg!(windows) {
        places.extend(('D'..='Z').map(|letter| PathBuf::from(format!("{letter}:\\"))));
    }
    places.retain(|place| place.join(INFO).is_file());
    places
}

/// The mount points of the file systems that a boot loader may show, from what Linux lists.
fn mount_points(mounts: &str) -> Vec<PathBuf> {
    let point = |line: &str| {
        let mut words = line.split(' ').skip(1);
        let (point, kind) = (words.next()?, words.next()?);
        // Blanks are written as octal codes.
        (kind == "vfat" || kind == "msdos").then(|| PathBuf::from(point.replace("\\040", " ")))
    };
    mounts.lines().filter_map(point).collect()
}

/// The chip behind a boot drive, as the drive says.
fn board(drive: &Path) -> Result<Family, CliError> {
    let info = fs::read_to_string(drive.join(INFO)).unwrap_or_default();
    let id =
        info.lines().find_map(|line| line.strip_prefix("Board-ID:")).unwrap_or_default().trim();
    match id {
        "RPI-RP2" => Ok(Family::Rp2040),
        "RP2350" => Ok(Family::Rp2350),
        other => {
            let message =
                format!("{} is the boot drive of \"{other}\", not of a Pico", drive.display());
            Err(CliError::new(
                Exit::Port,
                "flash.other_board",
                message,
                "unplug the other board, or name the Pico's with --drive",
            ))
        }
    }
}

fn name(family: Family) -> &'static str {
    match family {
        Family::Rp2040 => "a Pico (RP2040)",
        Family::Rp2350 => "a Pico 2 (RP2350)",
    }
}

fn copy(place: &Path, bytes: &[u8]) -> Result<(), CliError> {
    let written = File::create(place).and_then(|mut file| {
        file.write_all(bytes)?;
        // The board may restart before it has said that all is written.
        let _ = file.sync_all();
        Ok(())
    });
    written.map_err(|error| {
        let message = format!("{}: {error}", place.display());
        let help = "unplug the Pico, hold BOOTSEL while you plug it in, and flash again";
        CliError::new(Exit::File, "flash.copy", message, help)
    })
}

/// Waits until the board has left its boot loader.
fn taken(drive: &Path, place: &Path) -> Result<(), CliError> {
    let began = Instant::now();
    while drive.join(INFO).is_file() {
        if interrupted() {
            return Err(interrupted_error(
                "the file is on the drive; whether the board has taken it is not known",
            ));
        }
        if began.elapsed() > TAKEN {
            let message =
                format!("the board did not take {}: its drive is still there", place.display());
            let help = "unplug it, hold BOOTSEL while you plug it in, and flash again; another cable may help";
            return Err(CliError::new(Exit::Robot, "flash.not_taken", message, help));
        }
        std::thread::sleep(LOOK);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_drives_that_a_boot_loader_may_show_are_looked_at() {
        let mounts = "proc /proc proc rw 0 0\n/dev/sda1 / ext4 rw 0 0\n\
            /dev/sdb1 /media/me/RPI-RP2 vfat rw 0 0\n/dev/sdc1 /media/me/MY\\040STICK vfat rw 0 0\n";
        let places = mount_points(mounts);
        assert_eq!(places, [Path::new("/media/me/RPI-RP2"), Path::new("/media/me/MY STICK")]);
    }

    #[test]
    fn of_two_boards_none_is_chosen() {
        let drives = ["a", "b"].map(PathBuf::from);
        assert_eq!(only(&drives[..1]), Ok(Some("a".into())));
        assert_eq!(only(&drives).unwrap_err().code, "flash.several");
        assert_eq!(only(&[]), Ok(None));
    }

    #[test]
    fn a_drive_says_which_board_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let told = |text: &str| {
            fs::write(folder.path().join(INFO), text).unwrap();
            board(folder.path())
        };
        assert_eq!(
            told("UF2 Bootloader v3.0\nModel: Raspberry Pi RP2\nBoard-ID: RPI-RP2\n"),
            Ok(Family::Rp2040)
        );
        assert_eq!(
            told("UF2 Bootloader v1.0\r\nModel: Raspberry Pi RP2350\r\nBoard-ID: RP2350\r\n"),
            Ok(Family::Rp2350)
        );
        assert_eq!(told("Board-ID: SAMD21\n").unwrap_err().code, "flash.other_board");
    }
}
