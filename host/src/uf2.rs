//! UF2 files: a flash image cut into blocks that the Pico's boot loader takes as a copied file.
//!
//! Format: <https://github.com/microsoft/uf2>. Each block of 512 bytes carries 256 bytes of flash, their
//! address, and the family of chips that they are for.
//!
//! ```text
//! ELF ─► segments that are loaded to flash ─► one gapless image in pages ─► blocks
//! ```
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let elf = std::fs::read("target/firmware/pico.elf")?;
//! let image = wmr::uf2::Image::from_elf(&elf)?;
//! std::fs::write("target/firmware/pico.uf2", image.to_uf2())?;
//! # Ok(())
//! # }
//! ```

use std::ops::Range;

/// Bytes of flash in one block.
const PAGE: usize = 256;
/// Bytes of one block in the file.
const BLOCK: usize = 512;
/// Addresses of the flash on both chips.
const FLASH: Range<u32> = 0x1000_0000..0x1400_0000;
/// What unwritten flash reads as.
const ERASED: u8 = 0xff;
/// Marks the image definition that the RP2350's boot loader looks for in the first 4 KiB.
const RP2350_BLOCK_MARKER: [u8; 4] = 0xffff_ded3_u32.to_le_bytes();
/// How far into the image the RP2350's boot loader looks for it.
const RP2350_SEARCHED: usize = 4096;

const MAGIC_START: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
const MAGIC_END: u32 = 0x0ab1_6f30;
const FLAG_FAMILY: u32 = 0x2000;

const ELF_MAGIC: &[u8] = b"\x7fELF\x01\x01";
const ELF_PROGRAM_OFFSET: usize = 28;
const ELF_PROGRAM_SIZE: usize = 42;
const ELF_PROGRAM_COUNT: usize = 44;
const PROGRAM_LOAD: u32 = 1;

/// The chips that a UF2 file can be for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Raspberry Pi Pico.
    Rp2040,
    /// Raspberry Pi Pico 2, its Arm cores.
    Rp2350,
}

impl Family {
    /// The number by which boot loaders know the family.
    pub const fn id(self) -> u32 {
        match self {
            Self::Rp2040 => 0xe48b_ff56,
            Self::Rp2350 => 0xe48b_ff59,
        }
    }
}

/// Why an ELF file cannot become a UF2 file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
pub enum Uf2Error {
    /// The file is something else.
    #[error("this is no 32-bit ELF file")]
    #[diagnostic(help("firmware/build makes one in target/firmware"))]
    NotElf,
    /// A header points behind the end of the file.
    #[error("the ELF file ends early, at a part that should be at byte {offset}")]
    #[diagnostic(help("build it again with firmware/build"))]
    Truncated {
        /// Where the missing part should be.
        offset: usize,
    },
    /// The file is a program for something else.
    #[error("the ELF file puts nothing into flash, so it is not a Pico's")]
    #[diagnostic(help("take target/firmware/pico.elf"))]
    NothingForFlash,
    /// A UF2 file that is cut short, empty, or damaged.
    #[error("block {block} of the UF2 file is damaged or cut short")]
    #[diagnostic(help("copy the file again, or build it with firmware/build"))]
    Damaged {
        /// Counted from 0.
        block: usize,
    },
    /// The file is for another chip than those that this program knows.
    #[error("the UF2 file is for a chip of family {family:08x}, neither a Pico's nor a Pico 2's")]
    #[diagnostic(help("take target/firmware/pico.uf2 or pico2.uf2"))]
    Family {
        /// As the file says.
        family: u32,
    },
}

/// The chip that a UF2 file is for, once every one of its blocks is whole, in its place and for that chip.
///
/// # Errors
/// If a block is damaged, or the file is for another chip.
///
/// ```
/// assert!(wmr::uf2::family_of(b"not a firmware").is_err());
/// ```
pub fn family_of(uf2: &[u8]) -> Result<Family, Uf2Error> {
    let count = uf2.len() / BLOCK;
    let first = word(uf2, 28).map_err(|_| Uf2Error::Damaged { block: 0 })?;
    for (block, bytes) in uf2.chunks(BLOCK).enumerate() {
        let field = |offset| word(bytes, offset).map_err(|_| Uf2Error::Damaged { block });
        let marks = [field(0)?, field(4)?, field(BLOCK - 4)?];
        let place = [field(20)? as usize, field(24)? as usize];
        let [start, second] = MAGIC_START;
        if marks != [start, second, MAGIC_END] || place != [block, count] || field(28)? != first {
            return Err(Uf2Error::Damaged { block });
        }
    }
    [Family::Rp2040, Family::Rp2350]
        .into_iter()
        .find(|family| family.id() == first)
        .ok_or(Uf2Error::Family { family: first })
}

/// What an ELF file puts into flash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Address of the first byte, a multiple of the page size.
    start: u32,
    /// Whole pages.
    bytes: Vec<u8>,
}

impl Image {
    /// Reads what an ELF file puts into flash; gaps are left erased.
    ///
    /// # Errors
    /// If the bytes are not an ELF file for a Pico.
    pub fn from_elf(elf: &[u8]) -> Result<Self, Uf2Error> {
        let segments = flash_segments(elf)?;
        let start = segments.iter().map(|(address, _)| *address).min();
        let end = segments.iter().map(|(address, bytes)| *address as usize + bytes.len()).max();
        let (Some(start), Some(end)) = (start, end) else { return Err(Uf2Error::NothingForFlash) };
        let start = start - start % PAGE as u32;
        let mut bytes = vec![ERASED; (end - start as usize).next_multiple_of(PAGE)];
        for (address, content) in segments {
            let at = (address - start) as usize;
            bytes[at..at + content.len()].copy_from_slice(content);
        }
        Ok(Self { start, bytes })
    }

    /// The chip that would run this image.
    ///
    /// Only an RP2350's carries an image definition at its beginning.
    pub fn family(&self) -> Family {
        let searched = &self.bytes[..self.bytes.len().min(RP2350_SEARCHED)];
        let marked = searched.chunks_exact(4).any(|word| word == RP2350_BLOCK_MARKER);
        if marked { Family::Rp2350 } else { Family::Rp2040 }
    }

    /// The image as a UF2 file.
    pub fn to_uf2(&self) -> Vec<u8> {
        let family = self.family().id();
        let count = (self.bytes.len() / PAGE) as u32;
        let mut file = Vec::with_capacity(count as usize * BLOCK);
        for (index, page) in (0..).zip(self.bytes.chunks_exact(PAGE)) {
            let address = self.start + index * PAGE as u32;
            let [first, second] = MAGIC_START;
            let head = [first, second, FLAG_FAMILY, address, PAGE as u32, index, count, family];
            file.extend(head.iter().flat_map(|word| word.to_le_bytes()));
            file.extend_from_slice(page);
            file.resize(file.len() + BLOCK - 32 - PAGE - 4, 0);
            file.extend_from_slice(&MAGIC_END.to_le_bytes());
        }
        file
    }
}

/// The parts of an ELF file that are loaded to flash: address and content.
fn flash_segments(elf: &[u8]) -> Result<Vec<(u32, &[u8])>, Uf2Error> {
    if !elf.starts_with(ELF_MAGIC) {
        return Err(Uf2Error::NotElf);
    }
    let headers = word(elf, ELF_PROGRAM_OFFSET)? as usize;
    let size = half(elf, ELF_PROGRAM_SIZE)?;
    let mut segments = Vec::new();
    for index in 0..half(elf, ELF_PROGRAM_COUNT)? {
        let header = headers + index * size;
        let (offset, address) = (word(elf, header + 4)? as usize, word(elf, header + 12)?);
        let length = word(elf, header + 16)? as usize;
        if word(elf, header)? == PROGRAM_LOAD && length > 0 && FLASH.contains(&address) {
            let content = offset.checked_add(length).and_then(|end| elf.get(offset..end));
            segments.push((address, content.ok_or(Uf2Error::Truncated { offset })?));
        }
    }
    Ok(segments)
}

fn word(elf: &[u8], offset: usize) -> Result<u32, Uf2Error> {
    let bytes = elf.get(offset..).and_then(<[u8]>::first_chunk);
    bytes.map(|bytes| u32::from_le_bytes(*bytes)).ok_or(Uf2Error::Truncated { offset })
}

fn half(elf: &[u8], offset: usize) -> Result<usize, Uf2Error> {
    let bytes = elf.get(offset..).and_then(<[u8]>::first_chunk);
    bytes.map(|bytes| u16::from_le_bytes(*bytes).into()).ok_or(Uf2Error::Truncated { offset })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF file with two segments: 3 bytes at 0x1000_0000 and 2 bytes at 0x1000_0100.
    fn elf() -> Vec<u8> {
        let mut elf = vec![0; 52 + 2 * 32];
        elf[..6].copy_from_slice(ELF_MAGIC);
        elf[ELF_PROGRAM_OFFSET] = 52;
        elf[ELF_PROGRAM_SIZE] = 32;
        elf[ELF_PROGRAM_COUNT] = 2;
        let end = elf.len() as u32;
        for (index, (address, offset, length)) in
            [(0x1000_0000_u32, end, 3_u32), (0x1000_0100, end + 3, 2)].into_iter().enumerate()
        {
            let header = [PROGRAM_LOAD, offset, address, address, length, length, 5, 4];
            let bytes: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
            elf[52 + 32 * index..][..32].copy_from_slice(&bytes);
        }
        elf.extend([1, 2, 3, 4, 5]);
        elf
    }

    #[test]
    fn two_segments_become_two_blocks() {
        let file = Image::from_elf(&elf()).unwrap().to_uf2();
        assert_eq!(file.len(), 2 * BLOCK);
        let (first, second) = file.split_at(BLOCK);
        assert_eq!(first[12..16], 0x1000_0000_u32.to_le_bytes());
        assert_eq!(first[20..28], [0, 0, 0, 0, 2, 0, 0, 0], "block 0 of 2");
        assert_eq!(first[28..32], Family::Rp2040.id().to_le_bytes());
        assert_eq!(first[32..36], [1, 2, 3, ERASED]);
        assert_eq!(second[12..16], 0x1000_0100_u32.to_le_bytes());
        assert_eq!(second[32..35], [4, 5, ERASED]);
        assert_eq!(second[508..], MAGIC_END.to_le_bytes());
    }

    #[test]
    fn a_uf2_file_is_known_by_its_chip_and_damage_is_seen() {
        let file = Image::from_elf(&elf()).unwrap().to_uf2();
        assert_eq!(family_of(&file), Ok(Family::Rp2040));
        assert_eq!(family_of(&file[..BLOCK]), Err(Uf2Error::Damaged { block: 0 }), "1 of 2");
        assert_eq!(family_of(&file[..file.len() - 1]), Err(Uf2Error::Damaged { block: 0 }));
        assert_eq!(family_of(&[]), Err(Uf2Error::Damaged { block: 0 }));
        let mut other = file.clone();
        other[BLOCK..][..4].fill(0);
        assert_eq!(family_of(&other), Err(Uf2Error::Damaged { block: 1 }));
        let mut other = file;
        [0, BLOCK].into_iter().for_each(|block| other[block + 28] ^= 1);
        assert!(matches!(family_of(&other), Err(Uf2Error::Family { .. })));
    }

    #[test]
    fn an_image_definition_makes_it_an_rp2350s() {
        let mut elf = elf();
        let content = elf.len() - 5;
        elf.extend(RP2350_BLOCK_MARKER);
        // The first segment now begins with the marker.
        let marker = (content + 5) as u32;
        elf[52 + 4..52 + 8].copy_from_slice(&marker.to_le_bytes());
        elf[52 + 16] = 4;
        assert_eq!(Image::from_elf(&elf).unwrap().family(), Family::Rp2350);
    }

    #[test]
    fn other_files_are_refused() {
        assert_eq!(Image::from_elf(b"UF2\n"), Err(Uf2Error::NotElf));
        let elf = elf();
        let cut = &elf[..elf.len() - 1];
        assert!(matches!(Image::from_elf(cut), Err(Uf2Error::Truncated { .. })));
        let mut empty = elf.clone();
        empty[ELF_PROGRAM_COUNT] = 0;
        assert_eq!(Image::from_elf(&empty), Err(Uf2Error::NothingForFlash));
    }
}
