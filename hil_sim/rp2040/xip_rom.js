// Boot ROM functions and the flash controller's cache registers.
//
// The real ROM's code may not be shipped here, so each function that the firmware calls is two
// instructions: a breakpoint, which runs the JavaScript below, and a return.

import { BasePeripheral } from 'rp2040js';

const XIP_CTRL = 0x00;
const XIP_STAT = 0x08;
const XIP_CTRL_ENABLED = 3;
const XIP_STAT_FLUSH_READY = 1 | 2;

const ROM_BYTES = 16 * 1024;
const ROM_MAGIC = 0x10;
const ROM_FUNCTION_TABLE = 0x14;
const ROM_LOOKUP = 0x18;
const STUBS = 0x100;
const STUB_BYTES = 4;
const BKPT = 0xbe00;
const BX_LR = 0x4770;

const FLASH_OFFSET = 0xffffff;
const SECTOR_BYTES = 4096;
const PAGE_BYTES = 256;
// Typical times of the Pico's flash chip, in nanoseconds; the processor stands still meanwhile.
const SECTOR_ERASE_NANOS = 45e6;
const PAGE_PROGRAM_NANOS = 0.4e6;

export class XipControl extends BasePeripheral {
  readUint32(offset) {
    if (offset === XIP_CTRL) return XIP_CTRL_ENABLED;
    if (offset === XIP_STAT) return XIP_STAT_FLUSH_READY;
    return 0;
  }

  writeUint32() {}
}

const nothing = () => {};

// By the two-letter code of the ROM's function table (datasheet section 2.8.3). Arguments arrive in
// r0..r3, the result leaves in r0.
const FUNCTIONS = {
  IF: nothing, // connect_internal_flash
  EX: nothing, // flash_exit_xip
  FC: nothing, // flash_flush_cache
  CX: nothing, // flash_enter_cmd_xip
  RE: (chip, [offset, length]) => {
    chip.flash.fill(0xff, offset & FLASH_OFFSET, (offset & FLASH_OFFSET) + length);
    chip.stall((length / SECTOR_BYTES) * SECTOR_ERASE_NANOS);
  },
  RP: (chip, [offset, source, length]) => {
    for (let i = 0; i < length; i++) {
      // Programming can only clear bits.
      chip.flash[(offset & FLASH_OFFSET) + i] &= chip.rp2040.readUint8(source + i);
    }
    chip.stall((length / PAGE_BYTES) * PAGE_PROGRAM_NANOS);
  },
  UB: (chip) => chip.enterBootLoader(), // reset_to_usb_boot
  MC: copyMemory, // memcpy
  C4: copyMemory, // memcpy44
  MS: fillMemory, // memset
  S4: fillMemory, // memset4
};

function copyMemory(chip, [target, source, length]) {
  for (let i = 0; i < length; i++) {
    chip.rp2040.writeUint8(target + i, chip.rp2040.readUint8(source + i));
  }
  return target;
}

function fillMemory(chip, [target, value, length]) {
  for (let i = 0; i < length; i++) chip.rp2040.writeUint8(target + i, value & 0xff);
  return target;
}

const CODES = Object.keys(FUNCTIONS);
const LOOKUP = CODES.length;

/** The address of a stub, with the bit that says Thumb. */
function stubAddress(index) {
  return (STUBS + index * STUB_BYTES) | 1;
}

/** Writes the ROM image into the chip. */
export function installRom(rp2040) {
  const rom = new DataView(new ArrayBuffer(ROM_BYTES));
  rom.setUint8(ROM_MAGIC, 'M'.charCodeAt(0));
  rom.setUint8(ROM_MAGIC + 1, 'u'.charCodeAt(0));
  rom.setUint8(ROM_MAGIC + 2, 1);
  rom.setUint8(ROM_MAGIC + 3, 3);
  // The lookup stub finds functions by their code alone, whatever table it is given.
  rom.setUint16(ROM_FUNCTION_TABLE, STUBS, true);
  rom.setUint16(ROM_LOOKUP, stubAddress(LOOKUP), true);
  for (let index = 0; index <= LOOKUP; index++) {
    rom.setUint16(STUBS + index * STUB_BYTES, BKPT | index, true);
    rom.setUint16(STUBS + index * STUB_BYTES + 2, BX_LR, true);
  }
  rp2040.bootrom.set(new Uint32Array(rom.buffer));
}

/** Runs the ROM function behind a breakpoint number. */
export function callRom(chip, index) {
  const registers = chip.rp2040.core.registers;
  if (index === LOOKUP) {
    const code = String.fromCharCode(registers[1] & 0xff, (registers[1] >> 8) & 0xff);
    const found = CODES.indexOf(code);
    if (found < 0) throw new Error(`the firmware asks for the boot ROM function "${code}", which the emulator lacks`);
    registers[0] = stubAddress(found);
    return;
  }
  if (index > LOOKUP) throw new Error(`the firmware ran into breakpoint ${index}`);
  const result = FUNCTIONS[CODES[index]](chip, registers.slice(0, 4));
  if (result !== undefined) registers[0] = result;
}
