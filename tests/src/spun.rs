//! An emulated Pico on a bench: its wheels are turned by hand, and it is talked to over one of its ports.

use crate::POLL;
use hil_sim::emulator::EmulatedPico;
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;
use wmr::link::LinkClient;

/// A Pico whose wheels somebody turns, as a port: its UART or its USB.
pub struct Spun {
    /// The Pico.
    pub pico: EmulatedPico,
    /// Whether it is talked to over USB, or else over its UART.
    pub usb: bool,
    /// What its encoders have counted.
    pub counts: [i32; 2],
    /// What the host has sent and the Pico has not yet taken.
    pub to_robot: Vec<u8>,
    /// What the Pico has sent and the host has not yet read.
    pub to_host: VecDeque<u8>,
}

impl Spun {
    /// A host's end of that Pico's link, by USB or by UART.
    pub fn client(pico: EmulatedPico, usb: bool) -> LinkClient<Self> {
        let (to_robot, to_host) = (Vec::new(), VecDeque::new());
        LinkClient::new(Self { pico, usb, counts: [0; 2], to_robot, to_host }, 7)
    }

    /// Lets `steps` polls pass, in each of which the wheels turn by so many counts.
    pub fn turn(client: &mut LinkClient<Self>, steps: u32, counts: [i32; 2], now: &mut Duration) {
        for _ in 0..steps {
            let port = client.port_mut();
            port.counts = [port.counts[0] + counts[0], port.counts[1] + counts[1]];
            let mut uart_in = std::mem::take(&mut port.to_robot);
            if port.usb {
                port.pico.send_usb(&std::mem::take(&mut uart_in));
            }
            let step = port.pico.step(POLL, &uart_in, port.counts).unwrap();
            port.to_host.extend(if port.usb { step.usb_out } else { step.uart_out });
            *now += POLL;
            client.poll(*now).unwrap();
        }
    }
}

impl Read for Spun {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.to_host.is_empty() {
            Err(ErrorKind::WouldBlock.into())
        } else {
            self.to_host.read(buffer)
        }
    }
}

impl Write for Spun {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.to_robot.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
