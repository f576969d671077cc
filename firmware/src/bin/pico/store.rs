//! The parameters' two slots: the last two sectors of flash, which the linker's memory map leaves free.
//!
//! Erasing a sector stops the whole program for some 45 ms, so the robot asks for it only at rest.

use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, ERASE_SIZE, Flash};
use embassy_rp::peripherals::FLASH;
use wmr_firmware::parameter_store::{RECORD_SIZE, Slot, Step};

/// Bytes of flash on the board.
#[cfg(target_abi = "eabihf")]
const FLASH_SIZE: usize = 4096 * 1024;
/// Bytes of flash on the board.
#[cfg(not(target_abi = "eabihf"))]
const FLASH_SIZE: usize = 2048 * 1024;

/// Both slots.
pub(crate) struct Store {
    flash: Flash<'static, FLASH, Blocking, FLASH_SIZE>,
}

impl Store {
    /// The slots in the board's flash.
    pub(crate) fn new(flash: Peri<'static, FLASH>) -> Self {
        Self { flash: Flash::new_blocking(flash) }
    }

    /// The number that tells this board from all others: its flash chip's own.
    #[cfg(not(target_abi = "eabihf"))]
    pub(crate) fn chip(&mut self) -> u64 {
        let mut number = [0; 8];
        // A chip that does not say is one without a number.
        let _ = self.flash.blocking_unique_id(&mut number);
        u64::from_be_bytes(number)
    }

    /// The number that tells this board from all others: the processor's own.
    #[cfg(target_abi = "eabihf")]
    pub(crate) fn chip(&mut self) -> u64 {
        embassy_rp::otp::get_chipid().unwrap_or(0)
    }

    /// What a slot holds; zeros, which are no record, if it cannot be read.
    pub(crate) fn read(&mut self, slot: Slot) -> [u8; RECORD_SIZE] {
        let mut record = [0; RECORD_SIZE];
        if self.flash.blocking_read(address(slot), &mut record).is_err() {
            record = [0; RECORD_SIZE];
        }
        record
    }

    /// Takes `steps` with `record` and returns what the slot written to holds then.
    pub(crate) fn save(
        &mut self,
        steps: [Step; 2],
        record: &[u8; RECORD_SIZE],
    ) -> [u8; RECORD_SIZE] {
        let mut written = [0; RECORD_SIZE];
        for step in steps {
            // A failure shows in what is read back.
            match step {
                Step::Erase(slot) => {
                    let start = address(slot);
                    let _ = self.flash.blocking_erase(start, start + ERASE_SIZE as u32);
                }
                Step::Write(slot) => {
                    let _ = self.flash.blocking_write(address(slot), record);
                    written = self.read(slot);
                }
            }
        }
        written
    }
}

/// Where a slot starts, from the beginning of flash.
fn address(slot: Slot) -> u32 {
    let from_end = match slot {
        Slot::A => 2,
        Slot::B => 1,
    };
    (FLASH_SIZE - from_end * ERASE_SIZE) as u32
}
