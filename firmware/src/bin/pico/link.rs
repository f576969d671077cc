//! Carries bytes between the robot and its two ports. Knows nothing of frames.
//!
//! The control task owns the robot; this task only moves bytes through two pipes per port, so a
//! busy or dead port never delays the control tick.

use embassy_futures::join::{join, join5};
use embassy_futures::select::{Either, select};
use embassy_rp::peripherals::USB;
use embassy_rp::uart::{BufferedUart, BufferedUartRx, BufferedUartTx};
use embassy_rp::usb::Driver;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_sync::signal::Signal;
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::driver::EndpointError;
use embassy_usb::{Builder, Config, UsbDevice};
use embedded_io_async::{Read, Write};
use portable_atomic::{AtomicBool, Ordering};
use protocol::frame::MAX_FRAME;
use static_cell::StaticCell;
use wmr_firmware::robot::{Port, Robot};

/// Raspberry Pi's vendor number with the product number it gives to serial ports of users' programs.
const USB_VENDOR_PRODUCT: (u16, u16) = (0x2e8a, 0x000a);
/// What the host looks for before it opens a port by itself.
const USB_PRODUCT: &str = "wmr base";
/// Bulk endpoint size of full-speed USB, in bytes.
const USB_PACKET: usize = 64;
/// Opening the port at this speed and closing it asks for the boot loader, as on many boards.
const TOUCH_BAUD: u32 = 1200;

/// Bytes of one port waiting for the robot, at most.
const INBOUND: usize = 256;
/// Bytes of the robot waiting for one port, at most: [`LOW_WATER`] and one more frame.
const OUTBOUND: usize = LOW_WATER + MAX_FRAME;
/// Below this the robot may hand over more: a little over what a 115 200 baud line sends in one tick.
/// Small, so that a reply never waits behind much telemetry.
const LOW_WATER: usize = 64;
/// Bytes that the robot takes from one port in one tick, so that a flood cannot stretch it.
const PER_TICK: usize = 64;

/// The UART's bytes.
pub(crate) static UART: Wire = Wire::new();
/// The bytes of the USB serial port.
pub(crate) static USB_SERIAL: Wire = Wire::new();

static TICKED: Signal<CriticalSectionRawMutex, ()> = Signal::new();
static ALIVE: AtomicBool = AtomicBool::new(false);
static TOUCHED: AtomicBool = AtomicBool::new(false);

/// Asks this task to say that it runs, by the next tick.
pub(crate) fn ask_for_life() {
    TICKED.signal(());
}

/// Whether this task has run since the last call.
pub(crate) fn alive() -> bool {
    let alive = ALIVE.load(Ordering::Relaxed);
    ALIVE.store(false, Ordering::Relaxed);
    alive
}

/// Whether the host asked for the boot loader by the speed of the USB port since the last call.
pub(crate) fn touched() -> bool {
    let touched = TOUCHED.load(Ordering::Relaxed);
    TOUCHED.store(false, Ordering::Relaxed);
    touched
}

/// The bytes on their way between the robot and one port.
pub(crate) struct Wire {
    inbound: Pipe<CriticalSectionRawMutex, INBOUND>,
    outbound: Pipe<CriticalSectionRawMutex, OUTBOUND>,
}

impl Wire {
    const fn new() -> Self {
        Self { inbound: Pipe::new(), outbound: Pipe::new() }
    }

    /// Hands the robot what came in, and takes what it has to say. Called by the control task.
    pub(crate) fn serve(&self, robot: &mut Robot, port: Port) {
        let (mut chunk, mut count) = ([0; PER_TICK], 0);
        // A pipe gives bytes only up to its seam at once.
        while let Some(room @ [_, ..]) = chunk.get_mut(count..)
            && let Ok(more) = self.inbound.try_read(room)
        {
            count += more;
        }
        robot.receive(port, chunk.get(..count).unwrap_or_default());
        let mut frame = [0; MAX_FRAME];
        while self.outbound.len() < LOW_WATER {
            let count = robot.transmit(port, &mut frame);
            let bytes = frame.get(..count).unwrap_or_default();
            if bytes.is_empty() {
                break;
            }
            self.queue(bytes);
        }
    }

    /// The pipe takes bytes only up to its seam at once, so a frame may need two writes.
    fn queue(&self, mut bytes: &[u8]) {
        while let Ok(count @ 1..) = self.outbound.try_write(bytes) {
            bytes = bytes.get(count..).unwrap_or_default();
            if bytes.is_empty() {
                return;
            }
        }
    }
}

/// Moves bytes for ever, and proves in every control tick that it still does.
#[embassy_executor::task]
pub(crate) async fn link(uart: BufferedUart, driver: Driver<'static, USB>, chip: u64) {
    let (transmitter, receiver) = uart.split();
    let (mut device, class) = usb_serial(driver, chip);
    let (sender, usb_receiver, control) = class.split_with_control();
    join5(
        uart_in(receiver),
        uart_out(transmitter),
        device.run(),
        join(usb_in(usb_receiver), usb_out(sender, control)),
        beat(),
    )
    .await;
}

async fn beat() {
    loop {
        TICKED.wait().await;
        ALIVE.store(true, Ordering::Relaxed);
    }
}

async fn uart_in(mut receiver: BufferedUartRx) {
    let mut chunk = [0; 32];
    loop {
        // A line error loses bytes; the frames' checksum finds that out, so there is nothing to do.
        if let Ok(count) = receiver.read(&mut chunk).await {
            UART.inbound.write_all(chunk.get(..count).unwrap_or_default()).await;
        }
    }
}

async fn uart_out(mut transmitter: BufferedUartTx) {
    let mut chunk = [0; 32];
    loop {
        let count = UART.outbound.read(&mut chunk).await;
        // Writing to a UART has no way to fail.
        let _ = transmitter.write_all(chunk.get(..count).unwrap_or_default()).await;
    }
}

async fn usb_in(mut receiver: Receiver<'static, Driver<'static, USB>>) {
    let mut packet = [0; USB_PACKET];
    loop {
        receiver.wait_connection().await;
        while let Ok(count) = receiver.read_packet(&mut packet).await {
            USB_SERIAL.inbound.write_all(packet.get(..count).unwrap_or_default()).await;
        }
    }
}

async fn usb_out(
    mut sender: Sender<'static, Driver<'static, USB>>,
    control: ControlChanged<'static>,
) {
    loop {
        sender.wait_connection().await;
        // What was meant for the last listener would only puzzle the next one.
        USB_SERIAL.outbound.clear();
        loop {
            match select(control.control_changed(), forward(&mut sender)).await {
                Either::First(()) => {
                    if sender.line_coding().data_rate() == TOUCH_BAUD && !sender.dtr() {
                        TOUCHED.store(true, Ordering::Relaxed);
                    }
                }
                Either::Second(Ok(())) => {}
                Either::Second(Err(_)) => break,
            }
        }
    }
}

/// Sends what the robot has to say as one packet.
async fn forward(sender: &mut Sender<'static, Driver<'static, USB>>) -> Result<(), EndpointError> {
    // A full packet would make the host wait for the next one.
    let mut packet = [0; USB_PACKET - 1];
    let count = USB_SERIAL.outbound.read(&mut packet).await;
    sender.write_packet(packet.get(..count).unwrap_or_default()).await
}

/// The USB device with its one serial port.
fn usb_serial(
    driver: Driver<'static, USB>,
    chip: u64,
) -> (UsbDevice<'static, Driver<'static, USB>>, CdcAcmClass<'static, Driver<'static, USB>>) {
    static CONFIGURATION: StaticCell<[u8; 128]> = StaticCell::new();
    static DEVICE: StaticCell<[u8; 16]> = StaticCell::new();
    static SERIAL: StaticCell<[u8; 16]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();

    let (vendor, product) = USB_VENDOR_PRODUCT;
    let mut config = Config::new(vendor, product);
    config.manufacturer = Some("wmr");
    config.product = Some(USB_PRODUCT);
    // Without a number two robots would be one to the computer.
    config.serial_number = core::str::from_utf8(SERIAL.init(hexadecimal(chip))).ok();
    let mut builder = Builder::new(
        driver,
        config,
        CONFIGURATION.init([0; 128]),
        DEVICE.init([0; 16]),
        &mut [],
        CONTROL.init([0; 64]),
    );
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), USB_PACKET as u16);
    (builder.build(), class)
}

/// A number as 16 hexadecimal digits.
fn hexadecimal(number: u64) -> [u8; 16] {
    let mut digits = [0; 16];
    for (place, digit) in digits.iter_mut().enumerate() {
        let value = (number >> (60 - 4 * place)) as u8 & 15;
        *digit = if value < 10 { b'0' + value } else { b'a' - 10 + value };
    }
    digits
}
