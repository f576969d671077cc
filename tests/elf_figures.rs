//! What the flashed ELF costs: time of the control tick, memory, places where it can panic.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::emulator::{EmulatedPico, Tick};
use hil_sim::simulation::{Firmware, Simulation};
use protocol::motion::{Pose, Timing};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io};
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr_tests::drive;
use wmr_tests::elf_file::ElfFile;

/// 64 KiB; one more that buys `wmr check base`: a wheel that turns by itself, and wiring as parameters; one for
/// legs that must join and gains that must be stable; one for motors and encoders that must fit together, with
/// the name of the wheel that does not; and one for `wmr monitor`, encoders that say what they lose, a tick that
/// hangs on no alarm, and light patterns.
const FLASH_LIMIT: u32 = 68 * 1024;
/// Static memory and the most stack together.
const RAM_LIMIT: u32 = 24 * 1024;
/// Of 99.9 % of the ticks: a tenth of 5 ms at 125 MHz.
const TICK_LIMIT: u32 = 62_500;
const PERIOD: Duration = Duration::from_millis(5);
/// A hundredth of the period.
const JITTER_LIMIT: Duration = Duration::from_micros(50);
const READY_LIMIT: Duration = Duration::from_millis(50);
/// Calls of a panic in all crates together. May only fall.
const PANIC_CALLS_LIMIT: usize = 63;

/// What writing and reading a frame of 32 bytes takes together, cycles.
const FRAME_LIMIT: u32 = 3_000;

/// How our own crates show in a mangled name.
const OWN_CRATES: [&str; 2] = ["8firmware", "8protocol"];

/// The emulated Pico, with all its ticks kept.
struct Watched {
    pico: EmulatedPico,
    ticks: Vec<Tick>,
}

impl Firmware for Watched {
    const STEP: Duration = Duration::from_millis(1);

    fn step(
        &mut self,
        received: &[u8],
        counts: [i32; 2],
        sent: &mut VecDeque<u8>,
    ) -> io::Result<[f64; 2]> {
        let step =
            self.pico.step(<Self as Firmware>::STEP, received, counts).map_err(io::Error::other)?;
        sent.extend(step.uart_out);
        self.ticks.extend(step.ticks);
        Ok(step.duty)
    }
}

fn elf(board: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../target/firmware")).join(board)
}

/// The ticks of a mission with turns and drives, and the most stack it took.
fn mission() -> (Vec<Tick>, u32) {
    let pico = EmulatedPico::spawn(&elf("pico.elf")).unwrap();
    let base = WheeledBase::new(BaseParameters::seeded(4), TruePose::default());
    let robot = Simulation::new(Watched { pico, ticks: Vec::new() }, base, None);
    let way = [(0.0, 0.0), (0.6, 0.0), (0.7, 0.6), (0.1, 0.5)].map(|(x, y)| Point::new(x, y));
    let options = LegOptions { timing: Timing::Limits, reverse: true };
    let legs = to_legs(&way, 0.5, Some(2.0), &options, &DEFAULT_LIMITS);
    let (_, mut robot) = drive(robot, legs, Pose::new(0.0, 0.0, 0.5), 60, |_, _| {}).unwrap();
    let watched = robot.firmware_mut();
    (std::mem::take(&mut watched.ticks), watched.pico.stack_high_water().unwrap())
}

/// The latest minus the earliest start, against a clock that strikes every 5 ms.
fn jitter(ticks: &[Tick]) -> Duration {
    let late = (0..).zip(ticks).map(|(index, tick)| tick.start - PERIOD * index);
    late.clone().max().unwrap_or_default() - late.min().unwrap_or_default()
}

/// The cycles that frames of 32 bytes take: to write, to read, to collect and read, to write one of
/// telemetry; see firmware/src/bin/frame_cost.rs.
fn frame_cost() -> [u32; 4] {
    let mut pico = EmulatedPico::spawn(&elf("frame_cost.elf")).unwrap();
    let ticks = pico.step(Duration::from_millis(20), &[], [0; 2]).unwrap().ticks;
    let rounds: Vec<_> = ticks.chunks_exact(4).collect();
    assert!(rounds.len() > 10, "a frame of another length, or read as something else");
    [0, 1, 2, 3].map(|part| rounds.iter().map(|round| round[part].cycles).max().unwrap())
}

#[test]
fn the_elf_keeps_within_its_limits() {
    let bytes = ["pico.elf", "pico2.elf"].map(|board| fs::read(elf(board)).unwrap());
    let files = bytes.each_ref().map(|bytes| ElfFile::parse(bytes));
    let (ticks, stack) = mission();
    let mut cycles: Vec<u32> = ticks.iter().map(|tick| tick.cycles).collect();
    cycles.sort_unstable();
    let quantile = |part: f64| cycles[((cycles.len() - 1) as f64 * part).round() as usize];
    let [median, rare, most] = [0.5, 0.999, 1.0].map(quantile);
    let (jitter, ready) = (jitter(&ticks), ticks[0].start);

    println!("| figure | pico | pico2 |\n|---|---|---|");
    let [flash, ram] = [ElfFile::flash, ElfFile::static_ram].map(|size| files.each_ref().map(size));
    println!("| flash, bytes | {} | {} |", flash[0], flash[1]);
    println!("| static RAM, bytes | {} | {} |", ram[0], ram[1]);
    println!("| most stack in {} ticks, bytes | {stack} | |", ticks.len());
    println!("| tick, cycles: median | {median} | |");
    println!("| tick, cycles: 99.9 % | {rare} | |");
    println!("| tick, cycles: most | {most} | |");
    println!("| tick's jitter, us | {:.1} | |", jitter.as_secs_f64() * 1e6);
    println!("| reset to first tick, ms | {:.1} | |", ready.as_secs_f64() * 1e3);
    let [write, read, collect, telemetry] = frame_cost();
    println!("| 32-byte frame, cycles: write + read | {write} + {read} | |");
    println!("| the same, collected byte by byte and read | {collect} | |");
    println!("| 32 bytes of telemetry, cycles: write | {telemetry} | |");
    let panics = files.each_ref().map(ElfFile::panic_calls);
    println!("| panic calls | {} | {} |", panics[0].len(), panics[1].len());

    for board in 0..2 {
        assert!(flash[board] <= FLASH_LIMIT);
        assert!(ram[board] + stack <= RAM_LIMIT);
        assert!(panics[board].len() <= PANIC_CALLS_LIMIT, "{:#?}", panics[board]);
        let own = |name: &&str| OWN_CRATES.iter().any(|own| name.contains(own));
        assert!(!panics[board].iter().any(own), "{:#?}", panics[board]);
    }
    assert!(rare <= TICK_LIMIT);
    assert!(jitter <= JITTER_LIMIT);
    assert!(write + read <= FRAME_LIMIT);
    assert!(ready <= READY_LIMIT);
}
