//! What a frame of 32 bytes costs the board's processor; the emulator counts the cycles.
//!
//! The tick pin is high while a leg's result is written, then while a camera's pose is read, then while
//! the same is collected byte by byte from a wire and read, then while telemetry is written, whose floats
//! become whole numbers; so over and over. A frame of another length stops the program, so that
//! nothing else is measured by mistake.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "This program runs in the emulator: cargo test -p wmr-tests --features elf --test elf_figures"
    );
}

#[cfg(target_os = "none")]
mod board {
    use core::hint::black_box;
    use embassy_rp::gpio::{Level, Output};
    use protocol::frame::{Decoder, Header, MAX_FRAME, decode, encode};
    use protocol::message::{CameraPose, Command, LegResult, Report, State, Telemetry};
    use protocol::motion::{Pose, WheelSpeeds};
    use protocol::units::RadiansPerSecond;

    /// The frame's length with its closing zero.
    const LENGTH: usize = 32;
    const POSE: Pose = Pose::new(0.5, 1.0, 1.0);
    const TICKS: u32 = 10_000_000;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let pins = embassy_rp::init(embassy_rp::config::Config::default());
        let mut busy = Output::new(pins.PIN_15, Level::Low);
        let speed = RadiansPerSecond(5.0);
        let telemetry = Report::Telemetry(Telemetry {
            ticks: TICKS,
            pose: POSE,
            wheels: WheelSpeeds { left: speed, right: speed },
            state: State::Driving,
            leg: 3,
        });
        let done = Report::LegDone(LegResult { plan: 1, index: 3, ticks: 300, pose: POSE });
        let seen = Command::SetPose(CameraPose { ticks: TICKS, pose: POSE });
        let header = Header { session: 0x1234_5678, sequence: None, ack: 500, ack_bits: 3 };
        let (mut written, mut wire) = ([0; MAX_FRAME], [0; MAX_FRAME]);
        let numbered = Header { sequence: Some(7), ..header };
        let length = encode(&numbered, &seen, &mut wire).unwrap_or(0);
        let frame = wire.get(..length).unwrap_or_default();
        let mut decoder = Decoder::default();
        loop {
            busy.set_high();
            let result = encode(black_box(&numbered), black_box(&done), &mut written);
            busy.set_low();
            let mut scratch = [0; LENGTH - 1];
            // A frame of another length leaves zeros, which are none.
            if let Some(bytes) = frame.first_chunk() {
                scratch = *bytes;
            }
            busy.set_high();
            let whole = decode::<Command>(black_box(&mut scratch));
            busy.set_low();
            busy.set_high();
            let mut read = None;
            for byte in black_box(frame) {
                read = decoder.push::<Command>(*byte);
            }
            busy.set_low();
            busy.set_high();
            let packed = encode(black_box(&header), black_box(&telemetry), &mut written);
            busy.set_low();
            let is_right = black_box(whole) == Ok((numbered, seen))
                && black_box(read) == Some(Ok((numbered, seen)));
            if result != Ok(LENGTH) || packed != result || frame.len() != LENGTH || !is_right {
                stop();
            }
        }
    }

    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo) -> ! {
        stop()
    }

    fn stop() -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }
}
