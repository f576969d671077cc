//! Frames on the wire: postcard, then CRC-32C over header and payload, then COBS, then a zero.
//!
//! ```text
//! ┌────────┬─────────┬────────────┐
//! │ header │ message │ CRC-32C LE │ ─► COBS ─► 0x00
//! └────────┴─────────┴────────────┘
//! ```
//! COBS leaves no zero inside a frame, so a receiver that lost its place finds it at the next zero;
//! the CRC keeps what lies between two zeros from being taken for something else.

use crc::{CRC_32_ISCSI, Crc, Table};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// CRC-32C: finds every error of up to 5 bits in a frame of this length.
pub(crate) static CASTAGNOLI: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISCSI);

/// CRC-32C of `bytes`, for all that this project checks.
///
/// ```
/// // The check value of the CRC catalogue.
/// assert_eq!(wmr_protocol::frame::checksum(b"123456789"), 0xE306_9283);
/// ```
pub fn checksum(bytes: &[u8]) -> u32 {
    CASTAGNOLI.checksum(bytes)
}

const CRC_SIZE: usize = 4;
/// Header, message and CRC, before COBS.
const MAX_CONTENT: usize = 120;
/// The longest frame on the wire with its closing zero: COBS adds a byte for each 254 begun.
pub const MAX_FRAME: usize = MAX_CONTENT + 2;

/// What stands before every message; it never changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// The session that it belongs to; 0 before there is one.
    #[serde(with = "postcard::fixint::le")]
    pub session: u32,
    /// Its number, if it is on the reliable lane.
    pub sequence: Option<u16>,
    /// All of the other end's numbers before this one have arrived and been handled.
    #[serde(with = "postcard::fixint::le")]
    pub ack: u16,
    /// Bit i: number `ack` + i has arrived.
    pub ack_bits: u8,
}

/// Why a frame cannot be written or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// The frame does not fit.
    TooLong,
    /// What arrived is no COBS, or shorter than a CRC.
    Broken,
    /// The CRC differs: bytes were lost or changed.
    Damaged,
    /// The CRC is right, but the bytes are no message of this protocol.
    Unknown,
}

/// Writes one frame with its closing zero into `out`; returns its length.
///
/// # Errors
/// [`FrameError::TooLong`] if `out` or a frame is too short for it.
///
/// ```
/// use wmr_protocol::frame::*;
/// let mut wire = [0; MAX_FRAME];
/// let length = encode(&Header::default(), &7u8, &mut wire)?;
/// assert_eq!(wire[length - 1], 0);
/// let (header, message): (Header, u8) = decode(&mut wire[..length - 1])?;
/// assert_eq!(message, 7);
/// # Ok::<(), FrameError>(())
/// ```
pub fn encode<T: Serialize>(
    header: &Header,
    message: &T,
    out: &mut [u8],
) -> Result<usize, FrameError> {
    let most = out.len().min(MAX_FRAME);
    let body = out.get_mut(1..most).ok_or(FrameError::TooLong)?;
    let written = postcard::to_slice(&(header, message), body);
    let length = written.map_err(|_| FrameError::TooLong)?.len();
    seal(out.get_mut(..most).unwrap_or_default(), length)
}

/// Closes the frame around the `length` bytes that stand behind the first: CRC, COBS, zero.
///
/// A frame is shorter than the 254 bytes at which COBS would add another, so it is stuffed where it
/// stands: each zero becomes the distance to the next.
#[inline(never)]
fn seal(out: &mut [u8], length: usize) -> Result<usize, FrameError> {
    let end = 1 + length + CRC_SIZE;
    let (content, rest) = out.split_at_mut_checked(end).ok_or(FrameError::TooLong)?;
    *rest.first_mut().ok_or(FrameError::TooLong)? = 0;
    let (body, crc) = content.split_at_mut_checked(1 + length).ok_or(FrameError::TooLong)?;
    let (first, body) = body.split_first_mut().ok_or(FrameError::TooLong)?;
    *first = 0;
    let crc = crc.first_chunk_mut().ok_or(FrameError::TooLong)?;
    *crc = CASTAGNOLI.checksum(body).to_le_bytes();
    let mut distance = 1;
    for byte in content.iter_mut().rev() {
        if *byte == 0 {
            *byte = distance;
            distance = 0;
        }
        distance += 1;
    }
    Ok(end + 1)
}

/// Reads the frame that stood between two zeros; `bytes` is used as scratch space.
///
/// # Errors
/// [`FrameError`] if it is not a whole, undamaged frame that carries a `T`.
pub fn decode<T: DeserializeOwned>(bytes: &mut [u8]) -> Result<(Header, T), FrameError> {
    match postcard::take_from_bytes::<(Header, T)>(unseal(bytes)?) {
        Ok((content, [])) => Ok(content),
        _ => Err(FrameError::Unknown),
    }
}

/// Header and message of a frame, if they are undamaged.
#[inline(never)]
fn unseal(bytes: &mut [u8]) -> Result<&[u8], FrameError> {
    let mut place = 0;
    while let Some(byte) = bytes.get_mut(place) {
        let distance = core::mem::take(byte);
        if distance == 0 {
            return Err(FrameError::Broken);
        }
        place += usize::from(distance);
    }
    if place != bytes.len() {
        return Err(FrameError::Broken);
    }
    let content = bytes.get(1..).ok_or(FrameError::Broken)?;
    let (body, crc) = content.split_last_chunk::<CRC_SIZE>().ok_or(FrameError::Broken)?;
    if CASTAGNOLI.checksum(body) == u32::from_le_bytes(*crc) {
        Ok(body)
    } else {
        Err(FrameError::Damaged)
    }
}

/// Collects bytes until a zero closes a frame.
#[derive(Clone, Debug)]
pub struct Decoder {
    bytes: [u8; MAX_FRAME],
    length: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { bytes: [0; MAX_FRAME], length: 0 }
    }
}

impl Decoder {
    /// Takes one byte from the wire; at the end of a frame, what it held.
    ///
    /// Two zeros in a row hold nothing. What is longer than any frame is reported as an error at
    /// its zero, and forgotten.
    pub fn push<T: DeserializeOwned>(
        &mut self,
        byte: u8,
    ) -> Option<Result<(Header, T), FrameError>> {
        if byte != 0 {
            if let Some(place) = self.bytes.get_mut(self.length) {
                *place = byte;
            }
            self.length = (self.length + 1).min(MAX_FRAME + 1);
            return None;
        }
        let length = core::mem::take(&mut self.length);
        match self.bytes.get_mut(..length) {
            Some([]) => None,
            Some(frame) => Some(decode(frame)),
            None => Some(Err(FrameError::TooLong)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_check_value_of_crc_32c() {
        assert_eq!(CASTAGNOLI.checksum(b"123456789"), 0xE306_9283);
    }

    #[test]
    fn a_frame_by_hand() {
        let header = Header { session: 1, sequence: None, ack: 0, ack_bits: 0 };
        let mut wire = [0; MAX_FRAME];
        let length = encode(&header, &9u8, &mut wire).unwrap();
        let crc = CASTAGNOLI.checksum(&[1, 0, 0, 0, 0, 0, 0, 0, 9]).to_le_bytes();
        // COBS: 1 then a zero; six more zeros; then 9 and the CRC (no zero in it).
        assert!(!crc.contains(&0));
        let expected = [2, 1, 1, 1, 1, 1, 1, 1, 6, 9, crc[0], crc[1], crc[2], crc[3], 0];
        assert_eq!(&wire[..length], &expected);
    }

    #[test]
    fn a_decoder_finds_its_place_again_after_noise() {
        let mut wire = [0; MAX_FRAME];
        let length = encode(&Header::default(), &42u32, &mut wire).unwrap();
        let mut decoder = Decoder::default();
        let noise = [9u8; 3 * MAX_FRAME];
        let stream = noise.iter().chain(&[0, 0]).chain(&wire[..length]);
        let results: Vec<_> = stream.filter_map(|byte| decoder.push::<u32>(*byte)).collect();
        assert_eq!(results, [Err(FrameError::TooLong), Ok((Header::default(), 42))]);
    }

    proptest! {
        #[test]
        fn the_stuffing_is_that_of_the_cobs_crate(content in prop::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 1..80)) {
            let mut out = [0; MAX_FRAME];
            out[1..=content.len()].copy_from_slice(&content);
            let length = seal(&mut out, content.len()).unwrap();
            let crc = CASTAGNOLI.checksum(&content).to_le_bytes();
            let stuffed = cobs::encode_vec(&[&content[..], &crc].concat());
            prop_assert_eq!(&out[..length - 1], &stuffed[..]);
            prop_assert_eq!(out[length - 1], 0);
            prop_assert_eq!(unseal(&mut out[..length - 1]), Ok(&content[..]));
        }

        #[test]
        fn what_is_written_is_read(session: u32, sequence: Option<u16>, ack: u16, ack_bits: u8, message: [u32; 8]) {
            let header = Header { session, sequence, ack, ack_bits };
            let mut wire = [0; MAX_FRAME];
            let length = encode(&header, &message, &mut wire).unwrap();
            prop_assert_eq!(decode(&mut wire[..length - 1]), Ok((header, message)));
        }

        #[test]
        fn a_changed_byte_is_never_taken_for_a_message(message: [u32; 4], at: prop::sample::Index, xor in 1u8..) {
            let mut wire = [0; MAX_FRAME];
            let length = encode(&Header::default(), &message, &mut wire).unwrap();
            wire[at.index(length - 1)] ^= xor;
            prop_assert!(decode::<[u32; 4]>(&mut wire[..length - 1]).is_err());
        }

        #[test]
        fn any_bytes_are_survived(bytes: Vec<u8>) {
            let mut decoder = Decoder::default();
            for byte in bytes {
                let _ = decoder.push::<[u32; 4]>(byte);
            }
        }
    }
}
