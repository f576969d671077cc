//! The robot on a Raspberry Pi Pico or Pico 2: tasks and pins around [`wmr_firmware::robot::Robot`].
//!
//! ```text
//! UART ─┐                 pipes                 ┌─ encoders, battery
//!       ├─ link task  ◄──────────► control task ┤
//! USB  ─┘  (thread)                (interrupt)  └─ motors, watchdog
//! ```
//!
//! The control task owns the robot and runs above everything else on the processor, so neither the
//! ports nor the executor of the link task can delay it. It alone feeds the watchdog, and only while
//! the link task proves that it runs.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod control;
#[cfg(target_os = "none")]
mod encoders;
#[cfg(target_os = "none")]
mod faults;
#[cfg(target_os = "none")]
mod link;
#[cfg(all(target_os = "none", feature = "defmt"))]
mod log;
#[cfg(all(target_os = "none", not(feature = "defmt")))]
#[path = "no_log.rs"]
mod log;
#[cfg(target_os = "none")]
mod motors;
#[cfg(target_os = "none")]
mod period;
#[cfg(target_os = "none")]
mod store;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on a Raspberry Pi Pico; firmware/README.md says how to flash it.");
}
