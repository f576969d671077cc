// The pin that is high while the control task works: when each tick began and what it cost.

import { GPIOPinState } from 'rp2040js';
import { f64, u32 } from './frames.js';
import { TICK } from './wiring.js';

export class Ticks {
  constructor() {
    this.done = [];
  }

  /** Wires a chip up. */
  attach(chip) {
    const { core, gpio } = chip.rp2040;
    let start = null;
    gpio[TICK].addListener((state) => {
      if (state === GPIOPinState.High) {
        start = { nanos: chip.nanos, cycles: core.cycles };
      } else if (start) {
        this.done.push({ nanos: start.nanos, cycles: core.cycles - start.cycles });
        start = null;
      }
    });
  }

  /** The ticks since the last call, encoded: their number, then start in nanoseconds and cycles of each. */
  take() {
    const fields = this.done.flatMap(({ nanos, cycles }) => [f64(nanos), u32(cycles)]);
    const taken = Buffer.concat([u32(this.done.length), ...fields]);
    this.done = [];
    return taken;
  }
}
