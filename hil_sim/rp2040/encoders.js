// Quadrature encoders: turns the count that the simulated base reaches at the end of a step into
// edges spread evenly over it.

import { ENCODERS } from './wiring.js';

// Levels of channels A and B by count modulo 4: forward is A leading B.
const LEVELS = [
  [false, false],
  [true, false],
  [true, true],
  [false, true],
];

export class Encoders {
  constructor() {
    this.counts = [0, 0];
    // Coming edges: { nanos, wheel, count }, in the order of time.
    this.edges = [];
  }

  /** Wires a chip up. */
  attach(chip) {
    this.chip = chip;
    this.alarm = chip.rp2040.clock.createAlarm(() => this.step());
    this.counts.forEach((_, wheel) => this.show(wheel));
    this.scheduleNext();
  }

  /** Both wheels turn evenly, until at `end` they have reached `targets`. */
  turn(start, end, targets) {
    const edges = targets.flatMap((target, wheel) => {
      const from = this.counts[wheel];
      const way = target - from;
      return Array.from({ length: Math.abs(way) }, (_, index) => ({
        nanos: start + ((end - start) * (index + 0.5)) / Math.abs(way),
        wheel,
        count: from + Math.sign(way) * (index + 1),
      }));
    });
    this.edges = edges.sort((a, b) => a.nanos - b.nanos || a.wheel - b.wheel);
    this.scheduleNext();
  }

  scheduleNext() {
    if (this.edges.length > 0) this.alarm.schedule(Math.max(0, this.edges[0].nanos - this.chip.nanos));
  }

  step() {
    const { wheel, count } = this.edges.shift();
    this.chip.rp2040.pio[0].catchUp();
    this.counts[wheel] = count;
    this.show(wheel);
    this.scheduleNext();
  }

  /** Sets the wheel's two pins. */
  show(wheel) {
    const { gpio } = this.chip.rp2040;
    const [a, b] = LEVELS[((this.counts[wheel] % 4) + 4) % 4];
    gpio[ENCODERS[wheel].a].setInputValue(a);
    gpio[ENCODERS[wheel].b].setInputValue(b);
  }
}
