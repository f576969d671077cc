//! The control task: every 5 ms sense, decide, act; then the ports and the watchdog.

use embassy_executor::{InterruptExecutor, Spawner};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::rom_data::reset_to_usb_boot;
use embassy_rp::watchdog::Watchdog;
use embassy_time::{Duration, Instant};
use protocol::message::{Reboot, ResetCause};
use protocol::motion::TICK_MILLISECONDS;
use protocol::parameters::Parameters;
use static_cell::StaticCell;
use wmr_firmware::parameter_store::{Slot, Step};
use wmr_firmware::robot::{Boot, Port, Robot};

use crate::board::{self, BOARD, Base};
use crate::store::Store;
use crate::{faults, link, log};

/// The control period that [`Robot::tick`] counts on.
const TICK: Duration = Duration::from_millis(TICK_MILLISECONDS as u64);
/// The watchdog resets the chip when it has not been fed for this long.
const WATCHDOG_TIMEOUT: Duration = Duration::from_millis(100);
/// The watchdog's time while the flash is written.
const SAVE_TIMEOUT: Duration = Duration::from_secs(1);
/// Ticks without a beat of the link task after which the watchdog goes unfed. With
/// [`WATCHDOG_TIMEOUT`], a dead link task stops the motors within 150 ms.
const LINK_PATIENCE: u32 = 8;

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn SWI_IRQ_1() {
    #[expect(unsafe_code, reason = "called from the interrupt that the executor was started with")]
    unsafe {
        EXECUTOR.on_interrupt();
    }
}

#[embassy_executor::main]
async fn main(threads: Spawner) {
    let mut parts = board::take();
    parts.watchdog.start(WATCHDOG_TIMEOUT);
    let nonce = faults::boot_nonce(&mut parts.watchdog);
    let reset = faults::reset_cause(&mut parts.watchdog);
    let chip = parts.store.chip();
    log::started(nonce);

    // The timer and the UART stay above the control task: their handlers are short, and the UART's
    // buffer would overflow during a long tick. USB can wait: its host asks again.
    interrupt::SWI_IRQ_1.set_priority(Priority::P1);
    interrupt::USBCTRL_IRQ.set_priority(Priority::P2);
    let interrupts = EXECUTOR.start(interrupt::SWI_IRQ_1);
    if let (Ok(control), Ok(link)) = (
        control(parts.base, parts.store, nonce, reset, parts.watchdog),
        link::link(parts.uart, parts.usb, chip),
    ) {
        interrupts.spawn(control);
        threads.spawn(link);
    }
    core::future::pending::<()>().await;
}

/// Owns the robot.
#[embassy_executor::task]
async fn control(
    mut base: Base,
    mut store: Store,
    nonce: u32,
    reset: ResetCause,
    mut watchdog: Watchdog,
) {
    // What the task is given lies on the stack while it is spawned, so it is given little.
    let robot = made(Boot { nonce, board: BOARD, reset, chip: store.chip() });
    restore(robot, &mut store);
    let mut due = None;
    let mut silent_ticks = 0;
    loop {
        base.period.wait().await;
        base.tick.set_high();
        let missed_ticks = due.map_or(0, missed);
        due = Some(due.unwrap_or_else(Instant::now) + TICK * (u32::from(missed_ticks) + 1));
        let sensors = base.sense(missed_ticks, robot.battery_divider());
        let actuation = robot.tick(&sensors);
        base.motors.drive(actuation.duty);
        base.led.set_level(actuation.light.into());

        link::UART.serve(robot, Port::Uart);
        link::USB_SERIAL.serve(robot, Port::Usb);
        if link::touched() {
            robot.request_reboot(Reboot::Bootloader);
        }
        if let Some(target) = actuation.reboot {
            restart(&mut base, &mut watchdog, target);
        }

        if let Some(steps) = actuation.save {
            watchdog.feed(SAVE_TIMEOUT);
            save(robot, &mut store, steps);
            // The ticks of that time are not made up for: the wheels stood still.
            due = None;
        }

        link::ask_for_life();
        silent_ticks = if link::alive() { 0 } else { silent_ticks + 1 };
        if silent_ticks <= LINK_PATIENCE {
            watchdog.feed(WATCHDOG_TIMEOUT);
        }
        base.tick.set_low();
    }
}

/// The robot. Apart, so that it lies on the stack only while it is made.
#[inline(never)]
fn made(boot: Boot) -> &'static mut Robot {
    static ROBOT: StaticCell<Robot> = StaticCell::new();
    ROBOT.init_with(|| Robot::new(Parameters::default(), boot))
}

/// Takes what the flash holds. Apart, as [`save`] is, so that its pages lie on the stack only meanwhile.
#[inline(never)]
fn restore(robot: &mut Robot, store: &mut Store) {
    robot.restore([&store.read(Slot::A), &store.read(Slot::B)]);
}

/// Takes `steps` to have the flash hold the robot's parameters.
#[inline(never)]
fn save(robot: &mut Robot, store: &mut Store, steps: [Step; 2]) {
    let written = store.save(steps, &robot.parameter_record());
    robot.parameters_written(&written);
}

/// The control periods that have passed since the tick that was `due`.
fn missed(due: Instant) -> u8 {
    let late = Instant::now().saturating_duration_since(due);
    // The watchdog ends every wait long before it outgrows these numbers.
    (late.as_micros() as u32 / TICK.as_micros() as u32).min(u8::MAX.into()) as u8
}

/// Leaves this program; the robot asks for it only at rest.
fn restart(base: &mut Base, watchdog: &mut Watchdog, target: Reboot) {
    base.motors.off();
    match target {
        Reboot::Bootloader => reset_to_usb_boot(0, 0),
        Reboot::Application => watchdog.trigger_reset(),
    }
}
