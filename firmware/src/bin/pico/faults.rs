//! What happens when the program itself fails: motors off at once, then a reset.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use embassy_rp::clocks::RoscRng;
use embassy_rp::pac;
use embassy_rp::pac::io::vals::Outover;
use embassy_rp::peripherals::WATCHDOG;
use embassy_rp::watchdog::{ResetReason, Watchdog};
use protocol::message::ResetCause;

use crate::board::MOTOR_PINS;
use crate::log;

/// The register of the watchdog block that counts the boots since power came on; it survives resets.
const BOOTS_SCRATCH: usize = 0;

/// The register that says why the program itself asked for the last reset: a [`ResetCause`] as below.
const CAUSE_SCRATCH: usize = 1;
const PANIC: u32 = 1;
const HARD_FAULT: u32 = 2;

/// Why the chip has started; forgets it for the next time.
pub(crate) fn reset_cause(watchdog: &mut Watchdog) -> ResetCause {
    let noted = watchdog.get_scratch(CAUSE_SCRATCH);
    watchdog.set_scratch(CAUSE_SCRATCH, 0);
    match (watchdog.reset_reason(), noted) {
        (None, _) => ResetCause::PowerOn,
        (Some(ResetReason::TimedOut), _) => ResetCause::Watchdog,
        (Some(ResetReason::Forced), PANIC) => ResetCause::Panic,
        (Some(ResetReason::Forced), HARD_FAULT) => ResetCause::HardFault,
        (Some(ResetReason::Forced), _) => ResetCause::Command,
    }
}

/// A number that differs from boot to boot, so that the host notices a restart.
///
/// The ring oscillator's random bit gives it; a count of the boots is mixed in, so that two boots
/// after one power-on differ even if that bit is stuck.
pub(crate) fn boot_nonce(watchdog: &mut Watchdog) -> u32 {
    let boots = match watchdog.reset_reason() {
        None => 0,
        Some(_) => watchdog.get_scratch(BOOTS_SCRATCH).wrapping_add(1),
    };
    watchdog.set_scratch(BOOTS_SCRATCH, boots);
    RoscRng.next_u32() ^ boots.reverse_bits()
}

/// Holds every pin of the motor driver low, whatever block drives it.
pub(crate) fn motors_dead() {
    for pin in MOTOR_PINS {
        pac::IO_BANK0.gpio(pin).ctrl().modify(|ctrl| ctrl.set_outover(Outover::LOW));
    }
}

/// Switches the motors off and resets the chip, which remembers `cause`.
fn restart(cause: u32) -> ! {
    motors_dead();
    #[expect(unsafe_code, reason = "the owner of the watchdog will never run again")]
    let mut watchdog = Watchdog::new(unsafe { WATCHDOG::steal() });
    watchdog.set_scratch(CAUSE_SCRATCH, cause);
    watchdog.trigger_reset();
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panicked(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    motors_dead();
    log::panicked(info);
    restart(PANIC)
}

#[allow(unsafe_code, reason = "an exception handler is entered from outside the language")]
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    restart(HARD_FAULT)
}
