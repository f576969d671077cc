//! Quadrature encoders, counted by the programmable IO block: every edge of both channels (×4).
//!
//! One state machine per wheel samples channel A and B together and looks the pair (old, new) up in a
//! jump table. It keeps two counters that only fall, one for each direction, because a PIO program can
//! decrement but not increment:
//!
//! ```text
//!   Y falls by one for each forward edge      position = (X − Y) mod 2^16
//!   X falls by one for each backward edge
//! ```
//!
//! The low halves of both travel to the processor in one word, so they always belong together.
//! Forward is A leading B: (A, B) = 00, 10, 11, 01. If both channels change between two samples,
//! nothing is counted: the direction is unknown. A flag of the block, one for each machine, keeps that it
//! happened until the processor takes it.
//!
//! A pass takes at most ten instructions, 5 µs at [`SAMPLE_CLOCK`]: edges are safe up to 200 000 a second.

use embassy_rp::Peri;
use embassy_rp::clocks::clk_sys_freq;
use embassy_rp::gpio::Pull;
use embassy_rp::peripherals::PIO0;
use embassy_rp::pio::program::pio_asm;
use embassy_rp::pio::{
    Common, Config, Direction, IrqFlags, LoadedProgram, PioPin, ShiftDirection, StateMachine,
};

/// Instructions per second of the counting program, in Hz.
const SAMPLE_CLOCK: u32 = 2_000_000;

/// Loads the counting program, shared by both wheels.
pub(crate) fn load(common: &mut Common<'static, PIO0>) -> LoadedProgram<'static, PIO0> {
    let program = pio_asm!(
        ".origin 0"
        // Jump table: the address is B A of the old sample, then B A of the new one.
        "jmp report"   // 00 00
        "jmp forward"  // 00 01
        "jmp backward" // 00 10
        "jmp skipped"  // 00 11
        "jmp backward" // 01 00
        "jmp report"   // 01 01
        "jmp skipped"  // 01 10
        "jmp forward"  // 01 11
        "jmp forward"  // 10 00
        "jmp skipped"  // 10 01
        "jmp report"   // 10 10
        "jmp backward" // 10 11
        "jmp skipped"  // 11 00
        "jmp backward" // 11 01
        "jmp forward"  // 11 10
        "jmp report"   // 11 11
        "skipped:"
        "irq nowait 4 rel"
        "jmp report"
        "forward:"
        "jmp y-- report"
        // Reached from zero only: the counter has wrapped, and a jump on it is not taken.
        "jmp report"
        "backward:"
        "jmp x-- report"
        ".wrap_target"
        "report:"
        "in x, 16"
        "in y, 16"
        "push noblock"
        "out isr, 2"
        "in pins, 2"
        "mov osr, isr"
        "mov pc, isr"
        ".wrap"
    );
    common.load_program(&program.program)
}

/// The flags of the two machines: 4 and the machine's number, which no interrupt line listens to.
const SKIP_FLAGS: [u8; 2] = [4, 5];

/// Whether the left and the right encoder were found to have skipped an edge since the last call.
pub(crate) fn take_skips(flags: &IrqFlags<'static, PIO0>) -> [bool; 2] {
    let skipped = SKIP_FLAGS.map(|flag| flags.check_any(1 << flag));
    if skipped != [false; 2] {
        flags.clear_all(SKIP_FLAGS.iter().fold(0, |all, flag| all | 1 << flag));
    }
    skipped
}

/// The position of one wheel in counts, kept over any number of wraps of the hardware's counters.
pub(crate) struct Encoder<const SM: usize> {
    machine: StateMachine<'static, PIO0, SM>,
    last: u16,
    counts: i32,
}

impl<const SM: usize> Encoder<SM> {
    /// Starts counting from zero. `channel_b` must be the pin that follows `channel_a`.
    pub(crate) fn new(
        common: &mut Common<'static, PIO0>,
        mut machine: StateMachine<'static, PIO0, SM>,
        program: &LoadedProgram<'static, PIO0>,
        channel_a: Peri<'static, impl PioPin>,
        channel_b: Peri<'static, impl PioPin>,
    ) -> Self {
        let mut pins = [common.make_pio_pin(channel_a), common.make_pio_pin(channel_b)];
        for pin in &mut pins {
            // Encoder boards often have open-collector outputs.
            pin.set_pull(Pull::Up);
        }
        let [a, b] = &pins;
        let mut config = Config::default();
        config.use_program(program, &[]);
        config.set_in_pins(&[a, b]);
        config.shift_in.direction = ShiftDirection::Left;
        config.shift_out.direction = ShiftDirection::Right;
        config.clock_divider = ((clk_sys_freq() / SAMPLE_CLOCK) as u8).into();
        machine.set_pin_dirs(Direction::In, &[a, b]);
        machine.set_config(&config);
        machine.set_enable(true);
        let mut encoder = Self { machine, last: 0, counts: 0 };
        // The first pass compares with a sample that was never taken and may count one edge too many.
        encoder.position();
        encoder.last = encoder.position();
        encoder
    }

    /// Counts since the start; waits up to 5 µs for a fresh sample.
    pub(crate) fn counts(&mut self) -> i32 {
        let position = self.position();
        let travelled = position.wrapping_sub(self.last).cast_signed();
        self.last = position;
        self.counts = self.counts.wrapping_add(i32::from(travelled));
        self.counts
    }

    /// The hardware's position now: the queue holds old samples, so those are thrown away first.
    fn position(&mut self) -> u16 {
        let receiver = self.machine.rx();
        for _ in 0..receiver.level() {
            receiver.pull();
        }
        loop {
            if let Some(word) = receiver.try_pull() {
                let [x_high, x_low, y_high, y_low] = word.to_be_bytes();
                let backward = u16::from_be_bytes([x_high, x_low]);
                let forward = u16::from_be_bytes([y_high, y_low]);
                break backward.wrapping_sub(forward);
            }
        }
    }
}
