// One life of the chip: an RP2040 from reset to the next reset, with the peripherals that the stock
// emulator gets wrong replaced.

import { RP2040 } from 'rp2040js';
import { Pio } from './pio.js';
import { Pwm } from './pwm.js';
import { Rosc } from './rosc.js';
import { Uart } from './uart.js';
import { UsbController } from './usb.js';
import { Watchdog } from './watchdog.js';
import { XipControl, callRom, installRom } from './xip_rom.js';

const NANOS_PER_CYCLE = 8;
const VECTOR_TABLE = 0x10000100;
const RAM = 0x20000000;
const TIMER = 0x40054;
const IRQ_PIO0 = 7;
const IRQ_PIO1 = 9;
const IRQ_UART0 = 20;
const EXCEPTION_HARD_FAULT = 3;
const MODE_THREAD = 0;
// Fresh memory holds this, so that the deepest use of the stack can be seen afterwards.
const PAINT = 0xa5;

const silent = { debug() {}, info() {}, warn() {}, error() {} };

/** What a test may do to the processor. */
export const Freeze = { NONE: 0, ALL: 1, THREAD: 2 };

export class Chip {
  /**
   * `flash` and `randomBits` outlive the chip; `last` is the life before, unless the power was off.
   * `epoch` is the simulated time of this reset in nanoseconds.
   */
  constructor({ flash, randomBits, last, epoch, onByte, onOutput }) {
    this.epoch = epoch;
    this.stalledUntil = epoch;
    this.freeze = Freeze.NONE;
    this.resetAsked = false;
    // The boot loader itself is not emulated: a chip in it does nothing.
    this.inBootLoader = last?.bootLoaderAsked ?? false;
    this.bootLoaderAsked = false;
    this.rp2040 = new RP2040();
    this.rp2040.logger = silent;
    this.useFlash(flash);
    this.replacePeripherals({ randomBits, last, onByte, onOutput });
    installRom(this.rp2040);
    this.rp2040.sram.fill(PAINT);
    this.rp2040.onBreak = (code) => callRom(this, code);
    this.start();
  }

  /** Simulated time in nanoseconds. */
  get nanos() {
    return this.epoch + this.rp2040.clock.nanos;
  }

  get flash() {
    return this.rp2040.flash;
  }

  useFlash(flash) {
    this.rp2040.flash = flash;
    this.rp2040.flash16 = new Uint16Array(flash.buffer);
    this.rp2040.flashView = new DataView(flash.buffer);
  }

  replacePeripherals({ randomBits, last, onByte, onOutput }) {
    const { rp2040 } = this;
    rp2040.uart[0] = new Uart(rp2040, 'UART0', IRQ_UART0, onByte);
    rp2040.pio = [new Pio(rp2040, 'PIO0', IRQ_PIO0, 0), new Pio(rp2040, 'PIO1', IRQ_PIO1, 1)];
    rp2040.usbCtrl = new UsbController(rp2040, 'USB');
    rp2040.pwm = new Pwm(rp2040, 'PWM', onOutput);
    this.watchdog = new Watchdog(rp2040, 'WATCHDOG', last?.watchdog, () => {
      this.resetAsked = true;
    });
    Object.assign(rp2040.peripherals, {
      0x14000: new XipControl(rp2040, 'XIP_CTRL'),
      0x40034: rp2040.uart[0],
      0x40050: rp2040.pwm,
      0x40058: this.watchdog,
      0x40060: new Rosc(rp2040, 'ROSC', randomBits),
      0x50110: rp2040.usbCtrl,
      0x50200: rp2040.pio[0],
      0x50300: rp2040.pio[1],
    });
  }

  /** Starts the program as the second boot stage does. */
  start() {
    const { core } = this.rp2040;
    core.VTOR = VECTOR_TABLE;
    core.reset();
  }

  /** The processor stands still for a while, as it does while the flash is busy. */
  stall(nanos) {
    this.stalledUntil = Math.max(this.stalledUntil, this.nanos) + nanos;
  }

  /** The boot ROM resets the chip and starts its boot loader. */
  enterBootLoader() {
    this.bootLoaderAsked = true;
    this.resetAsked = true;
  }

  /** From now on no alarm of the timer fires; its time goes on. */
  loseAlarms() {
    this.rp2040.peripherals[TIMER].fireAlarm = () => {};
  }

  /** Makes the processor take a hard fault. */
  hardFault() {
    this.rp2040.core.waiting = false;
    this.rp2040.core.exceptionEntry(EXCEPTION_HARD_FAULT);
  }

  /** Continues at another address, as a failing program might. */
  jump(address) {
    this.rp2040.core.waiting = false;
    this.rp2040.core.PC = address & ~1;
  }

  /** Runs until the simulated time `end`, or until something asks for a reset. */
  run(end) {
    const { clock, core } = this.rp2040;
    while (this.nanos < end && !this.resetAsked) {
      if (this.idle()) {
        const alarm = clock.nextAlarm ? clock.nanosToNextAlarm : Infinity;
        const stall = this.stalledUntil > this.nanos ? this.stalledUntil : Infinity;
        clock.tick(Math.max(0, Math.min(alarm, end - this.nanos, stall - this.nanos)));
      } else {
        clock.tick(core.executeInstruction() * NANOS_PER_CYCLE);
      }
    }
  }

  /** Whether the processor executes nothing now; only time can change that. */
  idle() {
    const { core } = this.rp2040;
    if (this.inBootLoader || this.freeze === Freeze.ALL || this.nanos < this.stalledUntil) return true;
    if (this.freeze === Freeze.THREAD && core.currentMode === MODE_THREAD) {
      return !(core.interruptsUpdated && core.checkForInterrupts());
    }
    return core.waiting;
  }

  /** Bytes between the deepest use of the stack and its start, by the paint left above `staticEnd`. */
  stackHighWater(staticEnd) {
    const top = this.rp2040.readUint32(VECTOR_TABLE) - RAM;
    let deepest = staticEnd - RAM;
    while (deepest < top && this.rp2040.sram[deepest] === PAINT) deepest++;
    return top - deepest;
  }
}
