//! The control period, from a PWM slice that wraps 200 times a second.
//!
//! Not from the timer's alarm: every waiter of embassy-time hangs on one alarm of it, and an alarm that is
//! lost (embassy issue 6528, RP2350) would freeze them all. A slice counts on whatever happens, and raises its
//! interrupt again a period later. Nothing in this program waits for an alarm.

use embassy_rp::Peri;
use embassy_rp::clocks::clk_sys_freq;
use embassy_rp::interrupt;
use embassy_rp::pac;
use embassy_rp::peripherals::PWM_SLICE7;
use embassy_rp::pwm::{Config, Pwm};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use protocol::motion::TICKS_PER_SECOND;

/// Counts of the slice in one period: with this both boards' clocks divide by a whole number.
const COUNTS: u32 = 62_500;

static WRAPPED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// The slice, which drives no pin.
pub(crate) struct Period {
    _slice: Pwm<'static>,
}

impl Period {
    /// Starts it; the first period ends after 5 ms.
    pub(crate) fn start(slice: Peri<'static, PWM_SLICE7>) -> Self {
        let mut config = Config::default();
        config.top = (COUNTS - 1) as u16;
        config.divider = ((clk_sys_freq() / (COUNTS * TICKS_PER_SECOND)) as u8).into();
        let slice = Pwm::new_free(slice, config);
        enable();
        Self { _slice: slice }
    }

    /// Waits for the end of the period; returns at once if one has ended since the last call.
    pub(crate) async fn wait(&mut self) {
        WRAPPED.wait().await;
    }
}

fn on_wrap() {
    pac::PWM.intr().write(|wraps| wraps.set_ch7(true));
    WRAPPED.signal(());
}

#[cfg(not(target_abi = "eabihf"))]
#[interrupt]
fn PWM_IRQ_WRAP() {
    on_wrap();
}

#[cfg(not(target_abi = "eabihf"))]
fn enable() {
    pac::PWM.inte().write(|wraps| wraps.set_ch7(true));
    #[expect(unsafe_code, reason = "the handler above is all that runs from it")]
    unsafe {
        use embassy_rp::interrupt::InterruptExt;
        interrupt::PWM_IRQ_WRAP.enable();
    }
}

#[cfg(target_abi = "eabihf")]
#[interrupt]
fn PWM_IRQ_WRAP_0() {
    on_wrap();
}

#[cfg(target_abi = "eabihf")]
fn enable() {
    pac::PWM.irq0_inte().write(|wraps| wraps.set_ch7(true));
    #[expect(unsafe_code, reason = "the handler above is all that runs from it")]
    unsafe {
        use embassy_rp::interrupt::InterruptExt;
        interrupt::PWM_IRQ_WRAP_0.enable();
    }
}
