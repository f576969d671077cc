//! The parameters in flash: two slots that are written in turn, so that a power cut at any moment
//! leaves the old ones or the new ones.
//!
//! ```text
//! ┌───────┬────────┬──────────┬────────────┬────────┐
//! │ magic │ length │ sequence │ parameters │ CRC-32C │  all little-endian, the rest of the page 0xFF
//! └───────┴────────┴──────────┴────────────┴────────┘
//! ```
//! Each slot is one erasable sector. A save erases the slot that does not hold the valid record and
//! writes the new one there with the next sequence number; the other slot is not touched. When the
//! robot starts it takes the valid record with the later number. The CRC is written last and covers
//! everything before it, so a record that was cut off while being written is not valid.
//!
//! This module does no I/O: it says what to erase and write, and reads what it is shown.

use protocol::frame::checksum;
use protocol::parameters::ENCODED_SIZE;
use protocol::parameters::Parameters;

/// The bytes of a record: one page of the flash.
pub const RECORD_SIZE: usize = 256;

const MAGIC: u32 = 0x7072_6D77;
/// The layout of a record; of another, nothing is read.
const LAYOUT: u16 = 1;
const HEADER_SIZE: usize = 12;
const CRC_SIZE: usize = 4;

/// One of the two places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The first sector.
    A,
    /// The second sector.
    B,
}

impl Slot {
    /// The one that is not this one.
    pub fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// What to do to the flash, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Erase the slot's sector, to all 0xFF.
    Erase(Slot),
    /// Write the record to the beginning of the slot.
    Write(Slot),
}

/// What the flash holds, and where the next record goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterStore {
    slot: Slot,
    sequence: u32,
}

impl ParameterStore {
    /// Reads the two slots (A, B): the store, and the newest valid parameters if there are any.
    ///
    /// ```
    /// use wmr_firmware::parameter_store::{ParameterStore, RECORD_SIZE};
    /// let (_, parameters) = ParameterStore::read([&[0xFF; RECORD_SIZE], &[0xFF; RECORD_SIZE]]);
    /// assert_eq!(parameters, None);
    /// ```
    pub fn read([a, b]: [&[u8]; 2]) -> (Self, Option<Parameters>) {
        let newest = match (decode(a), decode(b)) {
            (Some(a), Some(b)) if is_later(b.0, a.0) => Some((Slot::B, b)),
            (Some(a), _) => Some((Slot::A, a)),
            (None, Some(b)) => Some((Slot::B, b)),
            (None, None) => None,
        };
        match newest {
            Some((slot, (sequence, parameters))) => (Self { slot, sequence }, Some(parameters)),
            // The first save then goes to A.
            None => (Self { slot: Slot::B, sequence: 0 }, None),
        }
    }

    /// The number of the record that is valid now; 0 if none is.
    pub fn sequence(&self) -> u32 {
        self.sequence
    }

    /// What to do to the flash to save, and the record to write.
    pub fn save(&self, parameters: &Parameters) -> ([Step; 2], [u8; RECORD_SIZE]) {
        let slot = self.slot.other();
        ([Step::Erase(slot), Step::Write(slot)], encode(self.sequence.wrapping_add(1), parameters))
    }

    /// Takes the save as done if `written`, read back from the slot, holds the record; else nothing
    /// has changed and false is returned.
    pub fn confirm(&mut self, parameters: &Parameters, written: &[u8]) -> bool {
        let expected = (self.sequence.wrapping_add(1), *parameters);
        let stored = decode(written) == Some(expected);
        if stored {
            *self = Self { slot: self.slot.other(), sequence: expected.0 };
        }
        stored
    }
}

/// Sequence numbers wrap: the later one is less than half their range ahead.
fn is_later(a: u32, b: u32) -> bool {
    (1..=u32::MAX / 2).contains(&a.wrapping_sub(b))
}

fn encode(sequence: u32, parameters: &Parameters) -> [u8; RECORD_SIZE] {
    let mut record = [0xFF; RECORD_SIZE];
    let mut payload = [0; ENCODED_SIZE];
    let payload = parameters.encode(&mut payload).and_then(|length| payload.get(..length));
    let payload = payload.unwrap_or_default();
    let length = (payload.len() as u16).to_le_bytes();
    let header = MAGIC.to_le_bytes().into_iter().chain(LAYOUT.to_le_bytes()).chain(length);
    let body = header.chain(sequence.to_le_bytes()).chain(payload.iter().copied());
    record.iter_mut().zip(body).for_each(|(place, byte)| *place = byte);
    if let Some((body, rest)) = record.split_at_mut_checked(HEADER_SIZE + payload.len()) {
        let crc = checksum(body).to_le_bytes();
        rest.iter_mut().zip(crc).for_each(|(place, byte)| *place = byte);
    }
    record
}

fn decode(record: &[u8]) -> Option<(u32, Parameters)> {
    let (magic, rest) = record.split_first_chunk()?;
    let (layout, rest) = rest.split_first_chunk()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (sequence, rest) = rest.split_first_chunk()?;
    let length = usize::from(u16::from_le_bytes(*length));
    let (payload, rest) = rest.split_at_checked(length)?;
    let crc: &[u8; CRC_SIZE] = rest.first_chunk()?;
    let valid = u32::from_le_bytes(*magic) == MAGIC
        && u16::from_le_bytes(*layout) == LAYOUT
        && checksum(record.get(..HEADER_SIZE + length)?) == u32::from_le_bytes(*crc);
    let parameters = Parameters::decode(payload).filter(|parameters| parameters.check().is_ok())?;
    valid.then_some((u32::from_le_bytes(*sequence), parameters))
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::units::Metres;

    const SECTOR: usize = 4096;

    fn robot(track: f32) -> Parameters {
        Parameters { track: Metres(track), ..Parameters::default() }
    }

    /// Two sectors that lose power after `cut` bytes of work.
    #[derive(Clone)]
    struct Flash {
        sectors: [Vec<u8>; 2],
    }

    impl Flash {
        fn blank() -> Self {
            Self { sectors: [vec![0xFF; SECTOR], vec![0xFF; SECTOR]] }
        }

        fn read(&self) -> (ParameterStore, Option<Parameters>) {
            ParameterStore::read([&self.sectors[0], &self.sectors[1]])
        }

        /// Saves, byte by byte; `doubtful` is what the byte at the cut holds afterwards.
        fn save(&mut self, parameters: &Parameters, cut: usize, doubtful: u8) {
            let (steps, record) = self.read().0.save(parameters);
            let mut left = cut;
            for step in steps {
                let (slot, bytes): (Slot, Vec<u8>) = match step {
                    Step::Erase(slot) => (slot, vec![0xFF; SECTOR]),
                    Step::Write(slot) => (slot, record.to_vec()),
                };
                let sector = &mut self.sectors[slot as usize];
                for (place, byte) in sector.iter_mut().zip(bytes) {
                    match left {
                        0 => return *place = doubtful,
                        _ => *place = byte,
                    }
                    left -= 1;
                }
            }
        }
    }

    #[test]
    fn what_is_saved_is_read_and_each_save_goes_to_the_other_slot() {
        let mut flash = Flash::blank();
        for (round, track) in [0.10, 0.11, 0.12, 0.13].into_iter().enumerate() {
            flash.save(&robot(track), usize::MAX, 0);
            let (store, parameters) = flash.read();
            assert_eq!((store.sequence(), parameters), (round as u32 + 1, Some(robot(track))));
            assert_eq!(store.slot, if round % 2 == 0 { Slot::A } else { Slot::B });
        }
    }

    #[test]
    fn a_power_cut_at_any_byte_leaves_the_old_or_the_new() {
        let (old, new) = (robot(0.11), robot(0.12));
        let mut before = Flash::blank();
        before.save(&robot(0.10), usize::MAX, 0);
        before.save(&old, usize::MAX, 0);
        let mut seen = [0, 0];
        for cut in 0..=SECTOR + RECORD_SIZE {
            for doubtful in [0x00, 0xFF, 0x5A] {
                let mut flash = before.clone();
                flash.save(&new, cut, doubtful);
                let found = flash.read().1;
                assert!(found == Some(old) || found == Some(new), "{cut}: {found:?}");
                seen[usize::from(found == Some(new))] += 1;
                // The next start saves again, whatever the cut left behind.
                flash.save(&robot(0.13), usize::MAX, 0);
                assert_eq!(flash.read().1, Some(robot(0.13)), "{cut}");
            }
        }
        assert!(seen[0] > 0 && seen[1] > 0);
    }

    #[test]
    fn a_first_save_that_is_cut_off_leaves_the_defaults() {
        for cut in 0..SECTOR + HEADER_SIZE {
            let mut flash = Flash::blank();
            flash.save(&robot(0.11), cut, 0x00);
            assert_eq!(flash.read().1, None, "{cut}");
        }
    }

    #[test]
    fn every_flipped_bit_makes_a_record_invalid() {
        let record = encode(7, &robot(0.11));
        let length =
            HEADER_SIZE + usize::from(u16::from_le_bytes([record[6], record[7]])) + CRC_SIZE;
        for bit in 0..length * 8 {
            let mut damaged = record;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(decode(&damaged), None, "{bit}");
        }
    }

    #[test]
    fn a_save_counts_only_if_it_can_be_read_back() {
        let mut store = ParameterStore::read([&[], &[]]).0;
        let (_, record) = store.save(&robot(0.11));
        assert!(!store.confirm(&robot(0.12), &record) && store.sequence() == 0);
        assert!(store.confirm(&robot(0.11), &record) && store.sequence() == 1);
    }

    #[test]
    fn sequence_numbers_wrap() {
        let (old, new) = (encode(u32::MAX, &robot(0.11)), encode(0, &robot(0.12)));
        assert_eq!(ParameterStore::read([&old, &new]).1, Some(robot(0.12)));
        assert_eq!(ParameterStore::read([&new, &old]).1, Some(robot(0.12)));
    }
}
