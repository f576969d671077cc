//! What an ELF file of the firmware says of itself: how much memory it takes, and where it can panic.

use std::collections::BTreeMap;
use std::ops::Range;

const FLASH: Range<u32> = 0x1000_0000..0x1400_0000;
const RAM: Range<u32> = 0x2000_0000..0x2010_0000;

const SECTION_OFFSET: usize = 32;
const SECTION_SIZE: usize = 46;
const SECTION_COUNT: usize = 48;
const SECTION_SYMBOLS: u32 = 2;
const SECTION_EMPTY: u32 = 8;
const SECTION_ALLOCATED: u32 = 2;
const SECTION_EXECUTABLE: u32 = 4;
const SYMBOL_BYTES: usize = 16;

/// Functions of the core library that end in the panic handler, by a part of their mangled names.
const PANICS: [&str; 3] = ["4core9panicking", "panic_already_borrowed", "13unwrap_failed"];

/// One section that takes memory on the chip.
struct Section {
    address: u32,
    size: u32,
    executable: bool,
    /// Where its content is in the file; none if it starts as zeros.
    content: Option<usize>,
}

/// A parsed ELF file.
pub struct ElfFile<'a> {
    bytes: &'a [u8],
    sections: Vec<Section>,
    /// Functions and mapping symbols by address, the bit for Thumb removed.
    symbols: BTreeMap<u32, Vec<&'a str>>,
}

impl<'a> ElfFile<'a> {
    /// Parses `bytes`.
    ///
    /// # Panics
    /// If they are not a whole 32-bit ELF file.
    pub fn parse(bytes: &'a [u8]) -> Self {
        let mut file = Self { bytes, sections: Vec::new(), symbols: BTreeMap::new() };
        let headers = file.word(SECTION_OFFSET) as usize;
        let (size, count) = (file.half(SECTION_SIZE), file.half(SECTION_COUNT));
        for header in (0..count).map(|index| headers + index * size) {
            let [kind, flags, address] = [4, 8, 12].map(|field| file.word(header + field));
            let [offset, size, link] = [16, 20, 24].map(|field| file.word(header + field));
            if kind == SECTION_SYMBOLS {
                let names = file.word(headers + link as usize * file.half(SECTION_SIZE) + 16);
                file.read_symbols(offset as usize, size as usize, names as usize);
            } else if flags & SECTION_ALLOCATED != 0 {
                file.sections.push(Section {
                    address,
                    size,
                    executable: flags & SECTION_EXECUTABLE != 0,
                    content: (kind != SECTION_EMPTY).then_some(offset as usize),
                });
            }
        }
        file
    }

    fn read_symbols(&mut self, table: usize, size: usize, names: usize) {
        for symbol in (table..table + size).step_by(SYMBOL_BYTES) {
            let name = &self.bytes[names + self.word(symbol) as usize..];
            let end = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
            let name = std::str::from_utf8(&name[..end]).unwrap_or_default();
            self.symbols.entry(self.word(symbol + 4) & !1).or_default().push(name);
        }
    }

    /// Bytes of flash: code, constants, and what initialises the RAM.
    pub fn flash(&self) -> u32 {
        let stored = self.sections.iter().filter(|section| section.content.is_some());
        stored.map(|section| section.size).sum()
    }

    /// Bytes of RAM before the stack.
    pub fn static_ram(&self) -> u32 {
        let ram = self.sections.iter().filter(|section| RAM.contains(&section.address));
        ram.map(|section| section.size).sum()
    }

    /// The functions that call a panic directly, each as often as it does.
    pub fn panic_calls(&self) -> Vec<&'a str> {
        let code = self.sections.iter().filter(|section| section.executable);
        code.flat_map(|section| self.panic_calls_in(section)).collect()
    }

    fn panic_calls_in(&self, section: &Section) -> Vec<&'a str> {
        let Some(content) = section.content else { return Vec::new() };
        let mut calls = Vec::new();
        let (mut function, mut is_code) = ("", true);
        for offset in (0..section.size as usize).step_by(2) {
            let address = section.address + offset as u32;
            for name in self.symbols.get(&address).into_iter().flatten() {
                // Mapping symbols tell code from constants between it.
                match *name {
                    "$t" => is_code = true,
                    "$d" => is_code = false,
                    name => function = name,
                }
            }
            let target = self.branch_target(content + offset, address).filter(|_| is_code);
            if target.is_some_and(|target| FLASH.contains(&target) && self.panics(target)) {
                calls.push(function);
            }
        }
        calls
    }

    fn panics(&self, address: u32) -> bool {
        let mut names = self.symbols.get(&address).into_iter().flatten();
        names.any(|name| PANICS.iter().any(|panic| name.contains(panic)))
    }

    /// Where the instruction at an offset of the file branches with link to, if it is `BL`.
    fn branch_target(&self, offset: usize, address: u32) -> Option<u32> {
        let first = u32::from(u16::from_le_bytes(*self.bytes.get(offset..)?.first_chunk()?));
        let second = u32::from(u16::from_le_bytes(*self.bytes.get(offset + 2..)?.first_chunk()?));
        if first >> 11 != 0b11110 || second >> 14 != 0b11 || second & 0x1000 == 0 {
            return None;
        }
        // S:I1:I2:imm10:imm11:0, where I = not (J xor S).
        let sign = (first >> 10) & 1;
        let [i1, i2] = [13, 11].map(|bit| !((second >> bit) ^ sign) & 1);
        let magnitude = (i1 << 23) | (i2 << 22) | ((first & 0x3ff) << 12) | ((second & 0x7ff) << 1);
        let jump = magnitude | if sign == 1 { 0xff00_0000 } else { 0 };
        Some(address.wrapping_add(4).wrapping_add(jump))
    }

    fn word(&self, offset: usize) -> u32 {
        self.bytes[offset..].first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes))
    }

    fn half(&self, offset: usize) -> usize {
        self.bytes[offset..].first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes).into())
    }
}
