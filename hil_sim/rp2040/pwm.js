// PWM slices as registers: the motors see a duty cycle, not edges.
//
// The stock model raises two clock events per period, a tenth of the whole emulation's time.

import { BasePeripheral } from 'rp2040js';

const SLICE_BYTES = 0x14;
const SLICES = 8;
const CSR = 0x00;
const CC = 0x0c;
const TOP = 0x10;
const EN = 0xa0;
const CSR_ENABLE = 1;

export class Pwm extends BasePeripheral {
  /** `onChange` is called after every write. */
  constructor(rp2040, name, onChange) {
    super(rp2040, name);
    this.onChange = onChange;
    this.registers = new Uint32Array(SLICES * (SLICE_BYTES / 4));
    // What the chip's pins and clock tree ask of the stock model.
    this.channels = [];
    this.gpioDirection = 0xffffffff;
    this.gpioValue = 0;
  }

  reset() {}

  gpioOnInput() {}

  /** The share of the time, 0..1, for which the slice holds this GPIO's output high. */
  duty(gpio) {
    const slice = (gpio >> 1) & (SLICES - 1);
    if (!(this.slice(slice, CSR) & CSR_ENABLE)) return 0;
    const compare = (this.slice(slice, CC) >>> (gpio & 1 ? 16 : 0)) & 0xffff;
    return Math.min(1, compare / ((this.slice(slice, TOP) & 0xffff) + 1));
  }

  slice(slice, register) {
    return this.registers[(slice * SLICE_BYTES + register) / 4];
  }

  readUint32(offset) {
    if (offset < EN) return this.registers[offset / 4];
    return 0;
  }

  writeUint32(offset, value) {
    if (offset < EN) this.registers[offset / 4] = value;
    this.onChange();
  }
}
