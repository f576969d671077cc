// The wire to the UART: bytes arrive one after the other at the speed of the line.

export class SerialLine {
  constructor() {
    this.waiting = [];
    this.sent = [];
  }

  /** Wires a chip up. */
  attach(chip) {
    this.uart = chip.rp2040.uart[0];
    this.alarm = chip.rp2040.clock.createAlarm(() => this.arrive());
    this.arriving = false;
    this.next();
  }

  /** Puts bytes on the wire, behind those still on it. */
  feed(bytes) {
    this.waiting.push(...bytes);
    this.next();
  }

  next() {
    if (this.arriving || this.waiting.length === 0) return;
    this.arriving = true;
    this.alarm.schedule(this.uart.byteNanos || BYTE_NANOS);
  }

  arrive() {
    this.arriving = false;
    this.uart.receive(this.waiting.shift());
    this.next();
  }

  /** The bytes that the chip has sent since the last call. */
  take() {
    const sent = this.sent;
    this.sent = [];
    return sent;
  }
}

// One byte at 115200 baud, for as long as the chip has not set its own speed.
const BYTE_NANOS = 86806;
