// PL011 UART with its FIFOs, baud timing and receive timeout.
//
// The stock model keeps the transmit interrupt asserted for ever, so a buffered driver never gets
// out of its handler. Register and bit names follow the RP2040 datasheet, section 4.2.

import { BasePeripheral, FIFO } from 'rp2040js';

const DR = 0x00;
const RSR = 0x04;
const FR = 0x18;
const IBRD = 0x24;
const FBRD = 0x28;
const LCR_H = 0x2c;
const CR = 0x30;
const IFLS = 0x34;
const IMSC = 0x38;
const RIS = 0x3c;
const MIS = 0x40;
const ICR = 0x44;
const DMACR = 0x48;

const FR_TXFE = 1 << 7;
const FR_RXFF = 1 << 6;
const FR_TXFF = 1 << 5;
const FR_RXFE = 1 << 4;
const FR_BUSY = 1 << 3;

const INT_OVERRUN = 1 << 10;
const INT_RECEIVE_TIMEOUT = 1 << 6;
const INT_TX = 1 << 5;
const INT_RX = 1 << 4;

const CR_UARTEN = 1 << 0;
const CR_RESET = 0x300;
const IFLS_RESET = 0x12;

const FIFO_DEPTH = 32;
// Levels at which the interrupts fire, by the two fields of IFLS.
const LEVELS = [4, 8, 16, 24, 28];
const BITS_PER_BYTE = 10;
const RECEIVE_TIMEOUT_BITS = 32;

export class Uart extends BasePeripheral {
  /** `onByte` gets each byte when its stop bit has left the chip. */
  constructor(rp2040, name, irq, onByte) {
    super(rp2040, name);
    this.irq = irq;
    this.onByte = onByte;
    this.rx = new FIFO(FIFO_DEPTH);
    this.tx = new FIFO(FIFO_DEPTH);
    this.registers = { [CR]: CR_RESET, [IFLS]: IFLS_RESET };
    this.raw = 0;
    this.shifting = null;
    this.shifter = rp2040.clock.createAlarm(() => this.byteSent());
    this.silence = rp2040.clock.createAlarm(() => this.lineSilent());
  }

  register(offset) {
    return this.registers[offset] ?? 0;
  }

  /** Time of one byte on the line, in nanoseconds; 0 while no baud rate is set. */
  get byteNanos() {
    const divider = this.register(IBRD) + this.register(FBRD) / 64;
    return (BITS_PER_BYTE * 16 * divider * 1e9) / this.rp2040.clkPeri;
  }

  /** A byte has arrived completely. */
  receive(byte) {
    if (!(this.register(CR) & CR_UARTEN)) return;
    if (this.rx.full) {
      this.raw |= INT_OVERRUN;
    } else {
      this.rx.push(byte);
      if (this.rx.itemCount >= LEVELS[(this.register(IFLS) >> 3) & 7]) this.raw |= INT_RX;
    }
    this.watchSilence();
    this.update();
  }

  watchSilence() {
    this.silence.schedule((this.byteNanos * RECEIVE_TIMEOUT_BITS) / BITS_PER_BYTE);
  }

  lineSilent() {
    if (!this.rx.empty) this.raw |= INT_RECEIVE_TIMEOUT;
    this.update();
  }

  send(byte) {
    if (this.shifting === null) this.shift(byte);
    else this.tx.push(byte);
    if (this.tx.itemCount > LEVELS[this.register(IFLS) & 7]) this.raw &= ~INT_TX;
    this.update();
  }

  shift(byte) {
    this.shifting = byte;
    this.shifter.schedule(this.byteNanos);
  }

  byteSent() {
    this.onByte(this.shifting);
    this.shifting = null;
    if (this.tx.empty) return;
    this.shift(this.tx.pull());
    if (this.tx.itemCount === LEVELS[this.register(IFLS) & 7]) this.raw |= INT_TX;
    this.update();
  }

  take() {
    const byte = this.rx.pull();
    if (this.rx.itemCount < LEVELS[(this.register(IFLS) >> 3) & 7]) this.raw &= ~INT_RX;
    if (this.rx.empty) {
      this.raw &= ~INT_RECEIVE_TIMEOUT;
      this.silence.cancel();
    } else {
      this.watchSilence();
    }
    this.update();
    return byte;
  }

  get flags() {
    return (
      (this.tx.empty ? FR_TXFE : 0) |
      (this.tx.full ? FR_TXFF : 0) |
      (this.rx.empty ? FR_RXFE : 0) |
      (this.rx.full ? FR_RXFF : 0) |
      (this.shifting === null ? 0 : FR_BUSY)
    );
  }

  update() {
    this.rp2040.setInterrupt(this.irq, (this.raw & this.register(IMSC)) !== 0);
  }

  /** Called by the chip when its peripheral clock changes; the baud rate is computed when used. */
  clkPeriChanged() {}

  readUint32(offset) {
    switch (offset) {
      case DR:
        return this.take();
      case FR:
        return this.flags;
      case RIS:
        return this.raw;
      case MIS:
        return this.raw & this.register(IMSC);
      case RSR:
      case IBRD:
      case FBRD:
      case LCR_H:
      case CR:
      case IFLS:
      case IMSC:
      case DMACR:
        return this.register(offset);
    }
    return super.readUint32(offset);
  }

  writeUint32(offset, value) {
    switch (offset) {
      case DR:
        this.send(value & 0xff);
        return;
      case ICR:
        this.raw &= ~this.rawWriteValue;
        this.update();
        return;
      default:
        this.registers[offset] = value;
        this.update();
    }
  }
}
