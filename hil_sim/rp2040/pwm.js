// PWM slices as registers: the motors see a duty cycle, not edges.
//
// The stock model raises two clock events per period, a tenth of the whole emulation's time. Here a slice
// has an event per period only while its wrap raises an interrupt.

import { BasePeripheral } from 'rp2040js';

const SLICE_BYTES = 0x14;
const SLICES = 8;
const CSR = 0x00;
const CC = 0x0c;
const TOP = 0x10;
const DIV = 0x04;
const EN = 0xa0;
const INTR = 0xa4;
const INTE = 0xa8;
const INTF = 0xac;
const INTS = 0xb0;
const CSR_ENABLE = 1;
const IRQ_WRAP = 4;
const NANOS_PER_SECOND = 1e9;

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
    this.wrapped = 0;
    this.interrupts = 0;
    this.periods = Array.from({ length: SLICES }, (_, slice) => {
      const alarm = rp2040.clock.createAlarm(() => this.wrap(slice));
      return { alarm, nanos: 0 };
    });
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
    if (offset === INTR) return this.wrapped;
    if (offset === INTE) return this.interrupts;
    if (offset === INTS) return this.wrapped & this.interrupts;
    return 0;
  }

  writeUint32(offset, value) {
    if (offset < EN) this.registers[offset / 4] = value;
    if (offset === INTR) this.wrapped &= ~this.rawWriteValue;
    if (offset === INTE) this.interrupts = value;
    if (offset === INTF) throw new Error('forced interrupts of PWM slices are not emulated');
    for (let slice = 0; slice < SLICES; slice++) this.keepPeriod(slice);
    this.raise();
    this.onChange();
  }

  /** Starts or stops a slice's wraps where its registers now say otherwise. */
  keepPeriod(slice) {
    const runs = this.slice(slice, CSR) & CSR_ENABLE && this.interrupts & (1 << slice);
    const cycles = ((this.slice(slice, TOP) & 0xffff) + 1) * ((this.slice(slice, DIV) & 0xfff) / 16);
    const nanos = runs ? (cycles * NANOS_PER_SECOND) / this.rp2040.clkSys : 0;
    const period = this.periods[slice];
    if (period.nanos === nanos) return;
    period.alarm.cancel();
    period.nanos = nanos;
    if (nanos > 0) period.alarm.schedule(nanos);
  }

  wrap(slice) {
    this.wrapped |= 1 << slice;
    this.periods[slice].alarm.schedule(this.periods[slice].nanos);
    this.raise();
  }

  raise() {
    this.rp2040.setInterrupt(IRQ_WRAP, (this.wrapped & this.interrupts) !== 0);
  }
}
