// What the emulator needs of an ELF file: the bytes for the flash, the end of the static data, symbols.

const HEADER_PROGRAM_OFFSET = 28;
const HEADER_SECTION_OFFSET = 32;
const HEADER_PROGRAM_SIZE = 42;
const PROGRAM_LOAD = 1;
const SECTION_SYMBOLS = 2;
const SYMBOL_BYTES = 16;
const RAM = 0x20000000;
const FLASH = 0x10000000;
const REGION_END = 0x04000000;

/** Returns `{ segments: [{ offset, bytes }], staticEnd, symbols: Map }`; offsets are relative to the flash. */
export function readElf(file) {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  if (file.length < 52 || view.getUint32(0) !== 0x7f454c46 || view.getUint8(4) !== 1) {
    throw new Error('not a 32-bit ELF file; firmware/build makes one');
  }
  const segments = [];
  let staticEnd = RAM;
  for (const header of programHeaders(view)) {
    const { address, loadAddress, offset, fileSize, memorySize } = header;
    if (loadAddress >= FLASH && loadAddress < FLASH + REGION_END && fileSize > 0) {
      segments.push({ offset: loadAddress - FLASH, bytes: file.subarray(offset, offset + fileSize) });
    }
    if (address >= RAM) staticEnd = Math.max(staticEnd, address + memorySize);
  }
  return { segments, staticEnd, symbols: readSymbols(file, view) };
}

function* programHeaders(view) {
  const start = view.getUint32(HEADER_PROGRAM_OFFSET, true);
  const size = view.getUint16(HEADER_PROGRAM_SIZE, true);
  const count = view.getUint16(HEADER_PROGRAM_SIZE + 2, true);
  for (let at = start; at < start + size * count; at += size) {
    if (view.getUint32(at, true) !== PROGRAM_LOAD) continue;
    yield {
      offset: view.getUint32(at + 4, true),
      address: view.getUint32(at + 8, true),
      loadAddress: view.getUint32(at + 12, true),
      fileSize: view.getUint32(at + 16, true),
      memorySize: view.getUint32(at + 20, true),
    };
  }
}

function readSymbols(file, view) {
  const symbols = new Map();
  const start = view.getUint32(HEADER_SECTION_OFFSET, true);
  const size = view.getUint16(HEADER_PROGRAM_SIZE + 4, true);
  const count = view.getUint16(HEADER_PROGRAM_SIZE + 6, true);
  const section = (index, field) => view.getUint32(start + size * index + field, true);
  for (let index = 0; index < count; index++) {
    if (section(index, 4) !== SECTION_SYMBOLS) continue;
    const names = section(section(index, 24), 16);
    const table = section(index, 16);
    for (let at = table; at < table + section(index, 20); at += SYMBOL_BYTES) {
      const name = names + view.getUint32(at, true);
      const text = file.subarray(name, file.indexOf(0, name)).toString('latin1');
      symbols.set(text, view.getUint32(at + 4, true));
    }
  }
  return symbols;
}
