// Which pins of the emulated Pico go where: the table of firmware/src/bin/pico/board.rs.

export const MOTORS = [
  { pwm: 2, in1: 4, in2: 5 },
  { pwm: 3, in1: 6, in2: 7 },
];
export const STANDBY = 8;
export const ENCODERS = [
  { a: 10, b: 11 },
  { a: 12, b: 13 },
];
export const TICK = 15;
export const BATTERY_CHANNEL = 0;
// Battery volts at the top of the analogue range, by the divider.
export const BATTERY_FULL_SCALE = 10.56;
