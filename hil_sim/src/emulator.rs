//! The flashed ELF as [`Firmware`]: an emulated Pico in a node process, run step by step.
//!
//! ```text
//! step: duration, counts, battery, bytes ─► hil_sim/rp2040/emulator.js ─► duty, resets, bytes
//! ```
//! Both ends exchange frames over the process's standard input and output: a length (u32), then
//! the content, all little-endian.
//!
//! | request | content |
//! |---|---|
//! | step | 1, duration in ns (u64), counts (2 × i32), battery in V (f32), for the UART and for USB: length (u32) and bytes |
//! | power cycle | 2 |
//! | fault | 3, which one (u8) |
//! | stack | 4 |
//! | USB line | 5, baud (u32), open (u8) |
//! | USB cable pulled | 6 |
//!
//! An answer is 0 and its content, or 1 and a text that says what went wrong. The answer to a step is the
//! mean duty (2 × f64), resets so far (u32), flags (u8), the number of ticks (u32) with start in ns (f64)
//! and cycles (u32) of each, and from the UART and from USB: length (u32) and bytes; that to a stack
//! request is a u32.
//!
//! The same ELF and the same steps give the same answers.

use crate::simulation::Firmware;
use std::collections::VecDeque;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Output, Stdio};
use std::time::Duration;

/// The emulator's scripts, packages beside them.
const SCRIPTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/rp2040");
/// What the script adds to what it is asked: it never sends more in one frame.
const LONGEST_ANSWER: usize = 1 << 24;

const OK: u8 = 0;
const STEP: u8 = 1;
const POWER_CYCLE: u8 = 2;
const FAULT: u8 = 3;
const STACK: u8 = 4;
const USB_LINE: u8 = 5;
const USB_UNPLUG: u8 = 6;

const FLAG_DRIVER_ENABLED: u8 = 1;
const FLAG_BOOT_LOADER: u8 = 2;

/// Why the emulator cannot be run.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum EmulatorError {
    /// There is no such ELF file.
    #[error("cannot read the firmware {}: {source}", path.display())]
    #[diagnostic(help("build it with firmware/build"))]
    Elf {
        /// Where it should be.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Node does not start.
    #[error("cannot start {program}: {source}")]
    #[diagnostic(help("the emulator needs Node.js 18 or later, https://nodejs.org"))]
    Node {
        /// The program that does not start.
        program: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// The packages cannot be installed.
    #[error("cannot install the emulator's packages: {reason}")]
    #[diagnostic(help("try `npm ci` in {SCRIPTS}"))]
    Packages {
        /// What npm says.
        reason: String,
    },
    /// The emulator says that it cannot go on.
    #[error("the emulated Pico has failed: {reason}")]
    #[diagnostic(help("build the firmware with firmware/build"))]
    Failed {
        /// What it says.
        reason: String,
    },
    /// The emulator's process has ended.
    #[error("the emulator has ended unexpectedly ({source})")]
    #[diagnostic(help("run the same again with node on your path"))]
    Gone {
        /// What happened to the pipe.
        source: io::Error,
    },
    /// The emulator answers nonsense.
    #[error("the emulator's answer is too short")]
    #[diagnostic(help("run `npm ci` in {SCRIPTS}, and firmware/build"))]
    Answer,
}

/// What one step brings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// What the firmware has sent over its UART.
    pub uart_out: Vec<u8>,
    /// What the firmware has sent over its USB serial port.
    pub usb_out: Vec<u8>,
    /// The motors' mean duty over the step, left and right, -1..=1.
    pub duty: [f64; 2],
    /// How often the chip has been reset since it was spawned, for whatever reason.
    pub resets: u32,
    /// The motor driver chip is switched on.
    pub driver_enabled: bool,
    /// The firmware has handed over to the boot loader.
    pub boot_loader: bool,
    /// The control ticks that ended within the step.
    pub ticks: Vec<Tick>,
}

/// What one control tick cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// When it began, since the emulator was spawned.
    pub start: Duration,
    /// Processor cycles until it ended, interrupts included.
    pub cycles: u32,
}

/// What a test can do to the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// None: ends a freeze.
    None = 0,
    /// The processor executes nothing any more.
    Freeze = 1,
    /// Only interrupts are executed, as if a task below them never gave way.
    FreezeThread = 2,
    /// The program panics.
    Panic = 3,
    /// The processor takes a hard fault.
    HardFault = 4,
    /// No alarm of the timer fires from now on, as if its interrupt were lost; time goes on.
    LostAlarms = 5,
}

/// A Pico that runs an ELF file, in a process of its own.
#[derive(Debug)]
pub struct EmulatedPico {
    process: Child,
    requests: ChildStdin,
    answers: ChildStdout,
    battery_volts: f32,
    usb_in: Vec<u8>,
}

impl EmulatedPico {
    /// Starts the firmware in `elf`. Installs the emulator's packages where they are missing.
    ///
    /// # Errors
    /// If the file, Node.js or the packages are missing, or the file is no firmware for a Pico.
    pub fn spawn(elf: &Path) -> Result<Self, EmulatorError> {
        let elf = fs::canonicalize(elf)
            .map_err(|source| EmulatorError::Elf { path: elf.to_path_buf(), source })?;
        install_packages()?;
        let node = |source| EmulatorError::Node { program: "node", source };
        let mut process = Command::new("node")
            .arg("emulator.js")
            .arg(elf)
            .current_dir(SCRIPTS)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(node)?;
        let (Some(requests), Some(answers)) = (process.stdin.take(), process.stdout.take()) else {
            return Err(node(io::ErrorKind::BrokenPipe.into()));
        };
        let mut pico = Self { process, requests, answers, battery_volts: 0.0, usb_in: Vec::new() };
        pico.answer()?;
        Ok(pico)
    }

    /// Lets `duration` pass, while the UART receives `uart_in` at the speed of its line and the wheels
    /// turn evenly until the encoders have reached `counts`.
    ///
    /// # Errors
    /// If the emulator fails or has ended.
    pub fn step(
        &mut self,
        duration: Duration,
        uart_in: &[u8],
        counts: [i32; 2],
    ) -> Result<Step, EmulatorError> {
        let nanos = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        let [left, right] = counts;
        let mut request = vec![STEP];
        request.extend(nanos.to_le_bytes());
        request.extend(left.to_le_bytes());
        request.extend(right.to_le_bytes());
        request.extend(self.battery_volts.to_le_bytes());
        for bytes in [uart_in, &std::mem::take(&mut self.usb_in)] {
            request.extend(u32::try_from(bytes.len()).unwrap_or(u32::MAX).to_le_bytes());
            request.extend(bytes);
        }
        let answer = self.ask(&request)?;
        Fields(&answer).step().ok_or(EmulatorError::Answer)
    }

    /// Switches the power off and on; flash keeps its content.
    ///
    /// # Errors
    /// If the emulator fails or has ended.
    pub fn reset(&mut self) -> Result<(), EmulatorError> {
        self.ask(&[POWER_CYCLE]).map(drop)
    }

    /// Puts `volts` on the battery's divider from the next step on; 0 for none.
    pub fn set_battery(&mut self, volts: f32) {
        self.battery_volts = volts;
    }

    /// Plugs the USB cable in if it is not, and sets the serial port's speed and whether it is open.
    ///
    /// # Errors
    /// If the emulator fails or has ended.
    pub fn set_usb_line(&mut self, baud: u32, open: bool) -> Result<(), EmulatorError> {
        let [a, b, c, d] = baud.to_le_bytes();
        self.ask(&[USB_LINE, a, b, c, d, open.into()]).map(drop)
    }

    /// Pulls the USB cable; the board goes on with its own battery.
    ///
    /// # Errors
    /// If the emulator fails or has ended.
    pub fn unplug_usb(&mut self) -> Result<(), EmulatorError> {
        self.usb_in.clear();
        self.ask(&[USB_UNPLUG]).map(drop)
    }

    /// Sends bytes to the USB serial port, from the next step on.
    pub fn send_usb(&mut self, bytes: &[u8]) {
        self.usb_in.extend(bytes);
    }

    /// Does something bad to the firmware.
    ///
    /// # Errors
    /// If the emulator fails or has ended.
    pub fn inject(&mut self, fault: Fault) -> Result<(), EmulatorError> {
        self.ask(&[FAULT, fault as u8]).map(drop)
    }

    /// The most bytes of stack used since the last reset.
    ///
    /// # Errors
    /// If the emulator fails or has ended.
    pub fn stack_high_water(&mut self) -> Result<u32, EmulatorError> {
        let answer = self.ask(&[STACK])?;
        Fields(&answer).u32().ok_or(EmulatorError::Answer)
    }

    fn ask(&mut self, request: &[u8]) -> Result<Vec<u8>, EmulatorError> {
        let length = u32::try_from(request.len()).unwrap_or(u32::MAX).to_le_bytes();
        self.requests
            .write_all(&[&length, request].concat())
            .and_then(|()| self.requests.flush())
            .map_err(|source| EmulatorError::Gone { source })?;
        self.answer()
    }

    fn answer(&mut self) -> Result<Vec<u8>, EmulatorError> {
        let gone = |source| EmulatorError::Gone { source };
        let mut length = [0; 4];
        self.answers.read_exact(&mut length).map_err(gone)?;
        let length = usize::try_from(u32::from_le_bytes(length)).unwrap_or(usize::MAX);
        if length == 0 || length > LONGEST_ANSWER {
            return Err(EmulatorError::Answer);
        }
        let mut answer = vec![0; length];
        self.answers.read_exact(&mut answer).map_err(gone)?;
        match answer.remove(0) {
            OK => Ok(answer),
            _ => Err(EmulatorError::Failed { reason: String::from_utf8_lossy(&answer).into() }),
        }
    }
}

impl Drop for EmulatedPico {
    fn drop(&mut self) {
        // It may have ended by itself; either way nothing is left to do.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Firmware for EmulatedPico {
    /// Short against the motors' time constant, so that the base feels a new duty soon enough.
    const STEP: Duration = Duration::from_millis(1);

    fn step(
        &mut self,
        received: &[u8],
        counts: [i32; 2],
        sent: &mut VecDeque<u8>,
    ) -> io::Result<[f64; 2]> {
        let step = EmulatedPico::step(self, <Self as Firmware>::STEP, received, counts)
            .map_err(io::Error::other)?;
        sent.extend(step.uart_out);
        Ok(step.duty)
    }

    fn set_battery(&mut self, volts: f64) {
        EmulatedPico::set_battery(self, volts as f32);
    }

    fn restart(&mut self) -> io::Result<()> {
        self.reset().map_err(io::Error::other)
    }
}

/// Fields yet to be read of an answer.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn step(mut self) -> Option<Step> {
        let duty = [self.f64()?, self.f64()?];
        let resets = self.u32()?;
        let [flags] = self.take()?;
        let ticks = (0..self.u32()?)
            .map(|_| {
                let start = Duration::from_nanos(self.f64()? as u64);
                Some(Tick { start, cycles: self.u32()? })
            })
            .collect::<Option<_>>()?;
        Some(Step {
            uart_out: self.bytes()?,
            usb_out: self.bytes()?,
            duty,
            resets,
            driver_enabled: flags & FLAG_DRIVER_ENABLED != 0,
            boot_loader: flags & FLAG_BOOT_LOADER != 0,
            ticks,
        })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }

    fn bytes(&mut self) -> Option<Vec<u8>> {
        let length = usize::try_from(self.u32()?).ok()?;
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(bytes.to_vec())
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }
}

/// Runs `npm ci` where the packages are missing; several processes may ask for it at the same time.
fn install_packages() -> Result<(), EmulatorError> {
    let packages = Path::new(SCRIPTS).join("node_modules/rp2040js");
    let failed = |reason: String| EmulatorError::Packages { reason };
    let lock = File::open(Path::new(SCRIPTS).join("package-lock.json"))
        .and_then(|file| file.lock().map(|()| file))
        .map_err(|error| failed(error.to_string()))?;
    if packages.is_dir() {
        return Ok(());
    }
    let Output { status, stderr, .. } = Command::new("npm")
        .args(["ci", "--no-audit", "--no-fund"])
        .current_dir(SCRIPTS)
        .stdin(Stdio::null())
        .output()
        .map_err(|source| EmulatorError::Node { program: "npm", source })?;
    drop(lock);
    if status.success() { Ok(()) } else { Err(failed(String::from_utf8_lossy(&stderr).into())) }
}
