// Programmable IO that runs on the simulated clock.
//
// The stock model runs from setTimeout and ignores the clock divider. Here a state machine is
// brought up to date whenever somebody could see a difference: before a register access, and before
// an input pin changes. In between, its inputs are constant, so a polling loop soon repeats itself;
// whole repetitions are skipped. Interrupts raised by a program would come late; the firmware uses none.

import { RPPIO } from 'rp2040js';

export class Pio extends RPPIO {
  constructor(rp2040, name, irq, index) {
    super(rp2040, name, irq, index);
    // Time up to which each state machine has run, in nanoseconds.
    this.doneNanos = [0, 0, 0, 0];
  }

  /** Stock hook that starts the timer; nothing runs by itself here. */
  run() {}

  /** Runs every enabled state machine up to now. */
  catchUp() {
    const now = this.rp2040.clock.nanos;
    for (const machine of this.machines) {
      if (!machine.enabled) {
        this.doneNanos[machine.index] = now;
        continue;
      }
      const period = this.period(machine);
      const cycles = Math.floor((now - this.doneNanos[machine.index]) / period);
      if (cycles > 0) this.doneNanos[machine.index] += runFor(machine, cycles) * period;
    }
  }

  /** Nanoseconds of one instruction. */
  period(machine) {
    const divider = (machine.clockDivInt || 65536) + machine.clockDivFrac / 256;
    return (divider * 1e9) / this.rp2040.clkSys;
  }

  readUint32(offset) {
    this.catchUp();
    return super.readUint32(offset);
  }

  writeUint32(offset, value) {
    this.catchUp();
    super.writeUint32(offset, value);
  }
}

/** Runs at least `cycles` cycles and returns how many they were; the last delay may exceed them. */
function runFor(machine, cycles) {
  let done = 0;
  let mark = null;
  while (done < cycles) {
    if (machine.pc === machine.wrapBottom && !machine.waiting) {
      const state = stateOf(machine);
      if (mark && sameState(mark.state, state)) {
        const loop = done - mark.done;
        done += Math.floor((cycles - done) / loop) * loop;
        mark = null;
        if (done >= cycles) break;
      } else {
        mark = { state, done };
      }
    }
    const before = machine.cycles;
    machine.step();
    done += Math.max(1, machine.cycles - before);
  }
  return done;
}

/** All that decides how a state machine goes on while its inputs stay as they are. */
function stateOf(machine) {
  return [
    machine.x,
    machine.y,
    machine.inputShiftReg,
    machine.outputShiftReg,
    machine.inputShiftCount,
    machine.outputShiftCount,
    machine.rxFIFO.itemCount,
    machine.txFIFO.itemCount,
  ];
}

function sameState(a, b) {
  return a.every((value, index) => value === b[index]);
}
