//! What USB says about a port: which device it is, wherever it turns up again, and whether a board
//! waits in its boot loader.

use serialport::{SerialPortInfo, SerialPortType};
use std::fs;
use std::path::Path;

/// Raspberry Pi, and the boot loaders of RP2040 and RP2350.
const BOOT_VENDOR: u16 = 0x2e8a;
const BOOT_PRODUCTS: [u16; 2] = [0x0003, 0x000f];

/// Where Linux lists all USB devices, serial ports or not. Other systems have no such folder, so
/// there nobody is told of a boot loader.
const DEVICES: &str = "/sys/bus/usb/devices";

/// What a USB device says of itself: the same after it was plugged in again, whatever its port is
/// called then.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct UsbIdentity {
    vid: u16,
    pid: u16,
    product: Option<String>,
    serial_number: Option<String>,
}

impl UsbIdentity {
    /// The device behind the port of that name; `None` if it is not on USB.
    pub(super) fn of(name: &str, ports: &[SerialPortInfo]) -> Option<Self> {
        // A link such as /dev/serial/by-id/... leads to the name that the system lists.
        let path = fs::canonicalize(name).ok();
        let name = path.as_deref().and_then(Path::to_str).unwrap_or(name);
        ports.iter().find(|port| port.port_name == name).and_then(Self::read)
    }

    fn read(port: &SerialPortInfo) -> Option<Self> {
        let SerialPortType::UsbPort(usb) = &port.port_type else { return None };
        Some(Self {
            vid: usb.vid,
            pid: usb.pid,
            product: usb.product.clone(),
            serial_number: usb.serial_number.clone(),
        })
    }

    /// The port of this device: the one of that name if it is this device, or the only one that is.
    pub(super) fn find(&self, name: &str, ports: &[SerialPortInfo]) -> Option<String> {
        if Self::of(name, ports).as_ref() == Some(self) {
            return Some(name.to_owned());
        }
        let mut same = ports.iter().filter(|port| Self::read(port).as_ref() == Some(self));
        match (same.next(), same.next()) {
            (Some(only), None) => Some(only.port_name.clone()),
            _ => None,
        }
    }
}

/// Whether a board on USB waits in its boot loader for a firmware.
pub(super) fn boot_loader_waits() -> bool {
    has_boot_loader(Path::new(DEVICES))
}

fn has_boot_loader(devices: &Path) -> bool {
    let Ok(entries) = fs::read_dir(devices) else { return false };
    entries.flatten().any(|device| {
        let number = |file| {
            let text = fs::read_to_string(device.path().join(file)).ok()?;
            u16::from_str_radix(text.trim(), 16).ok()
        };
        number("idVendor") == Some(BOOT_VENDOR)
            && number("idProduct").is_some_and(|product| BOOT_PRODUCTS.contains(&product))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::UsbPortInfo;

    fn port(name: &str, serial_number: &str) -> SerialPortInfo {
        let usb = UsbPortInfo {
            vid: BOOT_VENDOR,
            pid: 0x000a,
            serial_number: Some(serial_number.into()),
            manufacturer: Some("wmr".into()),
            product: Some("wmr base".into()),
        };
        SerialPortInfo { port_name: name.into(), port_type: SerialPortType::UsbPort(usb) }
    }

    #[test]
    fn a_device_is_found_again_under_another_name_and_no_other_in_its_place() {
        let before = [port("tty-0", "a"), port("tty-1", "b")];
        let a = UsbIdentity::of("tty-0", &before).unwrap();
        assert_eq!(a.find("tty-0", &before).as_deref(), Some("tty-0"));
        let moved = [port("tty-0", "b"), port("tty-2", "a")];
        assert_eq!(a.find("tty-0", &moved).as_deref(), Some("tty-2"));
        assert_eq!(a.find("tty-0", &[port("tty-0", "b")]), None);
        let twins = [port("tty-3", "a"), port("tty-4", "a")];
        assert_eq!(a.find("tty-0", &twins), None, "which of the two nobody can know");
        let plain = SerialPortInfo { port_name: "S0".into(), port_type: SerialPortType::Unknown };
        assert_eq!(UsbIdentity::of("S0", &[plain]), None);
    }

    #[test]
    fn a_board_in_its_boot_loader_is_seen_among_other_devices() {
        let folder = tempfile::tempdir().unwrap();
        let add = |name: &str, vendor: &str, product: &str| {
            let device = folder.path().join(name);
            fs::create_dir(&device).unwrap();
            fs::write(device.join("idVendor"), format!("{vendor}\n")).unwrap();
            fs::write(device.join("idProduct"), format!("{product}\n")).unwrap();
        };
        fs::create_dir(folder.path().join("1-1:1.0")).unwrap();
        add("1-1", "2e8a", "000a");
        add("1-2", "1d6b", "0003");
        assert!(!has_boot_loader(folder.path()));
        add("1-3", "2e8a", "000f");
        assert!(has_boot_loader(folder.path()));
        assert!(!has_boot_loader(&folder.path().join("no such folder")));
    }
}
