// The motor driver: turns pin levels into the mean duty of each motor over a step.

import { GPIOPinState } from 'rp2040js';
import { MOTORS, STANDBY } from './wiring.js';

const FUNCTION_PWM = 4;

export class Motors {
  constructor() {
    this.sums = [0, 0];
    this.now = [0, 0];
    this.since = 0;
    this.enabled = false;
  }

  /** Wires a chip up; its clock starts at `epoch` of the simulated time, in nanoseconds. */
  attach(chip) {
    this.chip = chip;
    const { gpio } = chip.rp2040;
    const pins = [STANDBY, ...MOTORS.flatMap(({ in1, in2 }) => [in1, in2])];
    for (const pin of pins) gpio[pin].addListener(() => this.changed());
    this.changed();
  }

  /** Some output of the chip has changed: what was true until now goes into the mean. */
  changed() {
    const now = this.chip.nanos;
    for (let motor = 0; motor < 2; motor++) {
      this.sums[motor] += this.now[motor] * (now - this.since);
      this.now[motor] = this.duty(MOTORS[motor]);
    }
    this.since = now;
    this.enabled = this.high(STANDBY);
  }

  high(pin) {
    return this.chip.rp2040.gpio[pin].value === GPIOPinState.High;
  }

  /** The truth table of the TB6612. */
  duty({ pwm, in1, in2 }) {
    if (!this.high(STANDBY) || this.high(in1) === this.high(in2)) return 0;
    const { gpio, pwm: slices } = this.chip.rp2040;
    if (gpio[pwm].functionSelect !== FUNCTION_PWM) return 0;
    return this.high(in1) ? slices.duty(pwm) : -slices.duty(pwm);
  }

  /** The mean duty of both motors, -1..1, since the last call. */
  takeMean(duration) {
    this.changed();
    const mean = this.sums.map((sum) => sum / duration);
    this.sums = [0, 0];
    return mean;
  }
}
