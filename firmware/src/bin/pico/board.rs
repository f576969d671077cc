//! The robot's wiring: which pin of the Pico goes where. Everything that depends on it is in this file.
//!
//! | pin | GPIO | signal | goes to |
//! |----:|-----:|--------|---------|
//! | 1 | 0 | UART TX | RX of the serial adapter (3.3 V) |
//! | 2 | 1 | UART RX | TX of the serial adapter (3.3 V) |
//! | 4 | 2 | left duty | TB6612 PWMA |
//! | 5 | 3 | right duty | TB6612 PWMB |
//! | 6 | 4 | left forward | TB6612 AIN1 |
//! | 7 | 5 | left backward | TB6612 AIN2 |
//! | 9 | 6 | right forward | TB6612 BIN1 |
//! | 10 | 7 | right backward | TB6612 BIN2 |
//! | 11 | 8 | standby | TB6612 STBY |
//! | 14 | 10 | left encoder A | encoder's channel A |
//! | 15 | 11 | left encoder B | encoder's channel B |
//! | 16 | 12 | right encoder A | encoder's channel A |
//! | 17 | 13 | right encoder B | encoder's channel B |
//! | 20 | 15 | tick | an oscilloscope: high while the control task works |
//! | 31 | 26 | battery | middle of a divider, 2.2 kΩ to battery +, 1 kΩ to ground; may be left open |
//! | – | 25 | LED | on the board (not on a W board): what the robot does, see `light.rs` |
//!
//! A Pico and a Pico 2 have the same pins. Which way round motors and encoders are connected, and what the
//! divider divides by, are parameters of the robot.

use embassy_rp::Peri;
use embassy_rp::adc::{Adc, Blocking, Channel};
use embassy_rp::gpio::{Level, Output, Pin, Pull};
use embassy_rp::peripherals::{PIO0, UART0, USB};
use embassy_rp::pio::{IrqFlags, Pio};
use embassy_rp::pwm::Pwm;
use embassy_rp::uart::{self, BufferedInterruptHandler, BufferedUart};
use embassy_rp::watchdog::Watchdog;
use embassy_rp::{adc, bind_interrupts, clocks, pac, pio, pwm, usb};
use protocol::message;
use static_cell::StaticCell;
use wmr_firmware::robot::Sensors;

use crate::encoders::{self, Encoder};
use crate::motors::{Direction, Motors};
use crate::period::Period;
use crate::store::Store;

/// The chip this program was built for.
#[cfg(target_abi = "eabihf")]
pub(crate) const BOARD: message::Board = message::Board::Pico2;
/// The chip this program was built for.
#[cfg(not(target_abi = "eabihf"))]
pub(crate) const BOARD: message::Board = message::Board::Pico;

/// GPIO numbers of all the motor driver's inputs, standby first.
pub(crate) const MOTOR_PINS: [usize; 7] = [8, 2, 3, 4, 5, 6, 7];

/// Above hearing, far below the driver's limit of 100 kHz. In Hz.
const PWM_FREQUENCY: u32 = 20_000;
/// Bits a second of the serial link, 8N1.
const UART_BAUD: u32 = 115_200;

/// GPIO number of the serial line's input.
const UART_RX_PIN: usize = 1;

/// Volts at the pin at the top of the converter's range.
const PIN_FULL_SCALE: f32 = 3.3;
/// Readings of the 12-bit converter.
const ADC_RANGE: f32 = 4096.0;
/// Erratum E9 makes an RP2350's pull-down a current source near 2.2 V, which would bend what a divider says.
#[cfg(target_abi = "eabihf")]
const BATTERY_PULL: Pull = Pull::None;
/// Holds an open pin near zero, and bends a divider of some kΩ by about a percent.
#[cfg(not(target_abi = "eabihf"))]
const BATTERY_PULL: Pull = Pull::Down;
/// Below this voltage no divider is fitted: an RP2040's own pull-down holds an open pin near zero. On an
/// RP2350 A2 it does not (erratum E9: an open pin may drift up to 2.2 V and beyond), so there only the
/// parameter `battery-divider` = 0 says that none is fitted.
const BATTERY_ABSENT: f32 = 2.0;

bind_interrupts!(pub(crate) struct Irqs {
    PIO0_IRQ_0 => pio::InterruptHandler<PIO0>;
    UART0_IRQ => BufferedInterruptHandler<UART0>;
    USBCTRL_IRQ => usb::InterruptHandler<USB>;
});

/// What the control task senses and drives.
pub(crate) struct Base {
    pub(crate) period: Period,
    pub(crate) motors: Motors,
    pub(crate) led: Output<'static>,
    skips: IrqFlags<'static, PIO0>,
    left: Encoder<0>,
    right: Encoder<1>,
    battery: Battery,
    /// High while the control task works.
    pub(crate) tick: Output<'static>,
}

impl Base {
    /// Reads both encoders and the battery behind a divider by `divider`, `missed_ticks` control periods
    /// late.
    pub(crate) fn sense(&mut self, missed_ticks: u8, divider: f32) -> Sensors {
        let counts = [self.left.counts(), self.right.counts()];
        let skipped = encoders::take_skips(&self.skips);
        Sensors { counts, skipped, battery: self.battery.volts(divider), missed_ticks }
    }
}

/// The battery's voltage behind its divider.
struct Battery {
    converter: Adc<'static, Blocking>,
    channel: Channel<'static>,
}

impl Battery {
    /// Volts, or none where no divider is fitted.
    fn volts(&mut self, divider: f32) -> Option<f32> {
        let reading = self.converter.blocking_read(&mut self.channel).ok()?;
        let volts = f32::from(reading) * (PIN_FULL_SCALE / ADC_RANGE) * divider;
        (volts > BATTERY_ABSENT).then_some(volts)
    }
}

/// Every part of the board that the program uses.
pub(crate) struct Parts {
    pub(crate) base: Base,
    pub(crate) uart: BufferedUart,
    pub(crate) usb: usb::Driver<'static, USB>,
    pub(crate) watchdog: Watchdog,
    pub(crate) store: Store,
}

/// Takes the chip and sets all pins up. The motors stay off until [`Motors::drive`] is called.
pub(crate) fn take() -> Parts {
    static UART_TX: StaticCell<[u8; 32]> = StaticCell::new();
    static UART_RX: StaticCell<[u8; 256]> = StaticCell::new();

    let chip = embassy_rp::init(embassy_rp::config::Config::default());

    let mut setting = pwm::Config::default();
    setting.top = (clocks::clk_sys_freq() / PWM_FREQUENCY - 1) as u16;
    let motors = Motors {
        pwm: Pwm::new_output_ab(chip.PWM_SLICE1, chip.PIN_2, chip.PIN_3, setting.clone()),
        setting,
        directions: [
            Direction { in1: low(chip.PIN_4), in2: low(chip.PIN_5) },
            Direction { in1: low(chip.PIN_6), in2: low(chip.PIN_7) },
        ],
        standby: low(chip.PIN_8),
    };

    let Pio { mut common, irq_flags: skips, sm0, sm1, .. } = Pio::new(chip.PIO0, Irqs);
    let program = encoders::load(&mut common);
    let left = Encoder::new(&mut common, sm0, &program, chip.PIN_10, chip.PIN_11);
    let right = Encoder::new(&mut common, sm1, &program, chip.PIN_12, chip.PIN_13);

    // The first samples had none before them.
    encoders::take_skips(&skips);

    let battery = Battery {
        converter: Adc::new_blocking(chip.ADC, adc::Config::default()),
        channel: Channel::new_pin(chip.PIN_26, BATTERY_PULL),
    };

    let mut line = uart::Config::default();
    line.baudrate = UART_BAUD;
    let (tx, rx) = (UART_TX.init([0; 32]), UART_RX.init([0; 256]));
    let uart = BufferedUart::new(chip.UART0, chip.PIN_0, chip.PIN_1, Irqs, tx, rx, line);
    // The driver leaves the input floating; with no adapter on it the motors' wires would make it chatter.
    pac::PADS_BANK0.gpio(UART_RX_PIN).modify(|pad| {
        pad.set_pue(true);
        pad.set_pde(false);
    });

    Parts {
        base: Base {
            period: Period::start(chip.PWM_SLICE7),
            motors,
            led: low(chip.PIN_25),
            skips,
            left,
            right,
            battery,
            tick: low(chip.PIN_15),
        },
        uart,
        usb: usb::Driver::new(chip.USB, Irqs),
        watchdog: Watchdog::new(chip.WATCHDOG),
        store: Store::new(chip.FLASH),
    }
}

/// An output that starts low.
fn low(pin: Peri<'static, impl Pin>) -> Output<'static> {
    Output::new(pin, Level::Low)
}
