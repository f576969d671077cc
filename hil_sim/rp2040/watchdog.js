// Watchdog timer with its scratch registers.
//
// The stock model re-arms itself with a delay of zero when it fires, an endless loop, and resets
// nothing. Here it asks for a chip reset; reason and scratch registers pass to the next life.

import { BasePeripheral } from 'rp2040js';

const CTRL = 0x00;
const LOAD = 0x04;
const REASON = 0x08;
const SCRATCH0 = 0x0c;
const SCRATCH7 = 0x28;
const TICK = 0x2c;

const CTRL_TRIGGER = 1 << 31;
const CTRL_ENABLE = 1 << 30;
const CTRL_TIME = 0xffffff;
const TICK_RUNNING = 1 << 10;
const TICK_ENABLE = 1 << 9;

const REASON_TIMER = 1;
const REASON_FORCE = 2;

// 1 MHz, but counted twice (erratum RP2040-E1).
const NANOS_PER_COUNT = 500;

export class Watchdog extends BasePeripheral {
  /** `last` is the watchdog of the life before, if any; `onReset` is called when the chip must reset. */
  constructor(rp2040, name, last, onReset) {
    super(rp2040, name);
    this.onReset = onReset;
    this.reason = last?.reason ?? 0;
    this.scratch = last?.scratch ?? new Uint32Array(8);
    this.control = 0;
    this.load = 0;
    this.alarm = rp2040.clock.createAlarm(() => this.fire(REASON_TIMER));
  }

  fire(reason) {
    this.reason = reason;
    this.alarm.cancel();
    this.onReset();
  }

  arm() {
    if (this.control & CTRL_ENABLE) this.alarm.schedule(this.load * NANOS_PER_COUNT);
    else this.alarm.cancel();
  }

  readUint32(offset) {
    if (offset >= SCRATCH0 && offset <= SCRATCH7) return this.scratch[(offset - SCRATCH0) / 4];
    switch (offset) {
      case CTRL:
        return this.control;
      case LOAD:
        return this.load;
      case REASON:
        return this.reason;
      case TICK:
        return TICK_RUNNING | TICK_ENABLE;
    }
    return super.readUint32(offset);
  }

  writeUint32(offset, value) {
    if (offset >= SCRATCH0 && offset <= SCRATCH7) {
      this.scratch[(offset - SCRATCH0) / 4] = value;
      return;
    }
    switch (offset) {
      case CTRL:
        this.control = value & ~(CTRL_TRIGGER | CTRL_TIME);
        this.arm();
        if (value & CTRL_TRIGGER) this.fire(REASON_FORCE);
        return;
      case LOAD:
        this.load = value & CTRL_TIME;
        this.arm();
        return;
    }
  }
}
