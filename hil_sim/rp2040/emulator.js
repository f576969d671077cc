// Runs an ELF file of the firmware in an emulated RP2040, in lockstep with whoever sits at the other
// end of standard input and output. Usage: node emulator.js FILE.elf
//
//   { duration, encoder counts, battery, bytes in } ─► chip ─► { duty, resets, flags, ticks, bytes out }
//
// The same file and the same steps give the same answers: no wall clock, no timers, seeded randomness.

import fs from 'node:fs';
import { Chip, Freeze } from './chip.js';
import { readElf } from './elf.js';
import { Encoders } from './encoders.js';
import { Reader, bytes, f64, readFrame, u32, u8, writeFrame } from './frames.js';
import { Motors } from './motors.js';
import { RandomBits } from './rosc.js';
import { SerialLine } from './serial_line.js';
import { Ticks } from './ticks.js';
import { UsbHost } from './usb.js';
import { BATTERY_CHANNEL, BATTERY_FULL_SCALE } from './wiring.js';

const FLASH_BYTES = 16 * 1024 * 1024;
const ADC_RANGE = 4096;

const Request = { STEP: 1, POWER_CYCLE: 2, FAULT: 3, STACK: 4, USB_LINE: 5, USB_UNPLUG: 6 };
const Fault = { NONE: 0, FREEZE: 1, FREEZE_THREAD: 2, PANIC: 3, HARD_FAULT: 4, LOST_ALARMS: 5 };
const Flag = { DRIVER_ENABLED: 1, BOOT_LOADER: 2 };
const OK = 0;
const FAILED = 1;

class Emulator {
  constructor(elf) {
    this.elf = elf;
    this.flash = new Uint8Array(FLASH_BYTES).fill(0xff);
    for (const { offset, bytes: content } of elf.segments) this.flash.set(content, offset);
    this.randomBits = new RandomBits();
    this.motors = new Motors();
    this.encoders = new Encoders();
    this.line = new SerialLine();
    this.ticks = new Ticks();
    this.usb = new UsbHost();
    this.resets = 0;
    this.end = 0;
    this.batteryVolts = 0;
    this.boot(null);
  }

  /** Starts the next life of the chip; `last` is the one before, unless the power was off. */
  boot(last) {
    this.chip = new Chip({
      flash: this.flash,
      randomBits: this.randomBits,
      last,
      epoch: this.chip?.nanos ?? 0,
      onByte: (byte) => this.line.sent.push(byte),
      onOutput: () => this.motors.changed(),
    });
    const { motors, encoders, line, ticks, usb } = this;
    for (const device of [motors, encoders, line, ticks, usb]) device.attach(this.chip);
    this.setBattery(this.batteryVolts);
  }

  setBattery(volts) {
    this.batteryVolts = volts;
    const reading = Math.round((volts / BATTERY_FULL_SCALE) * ADC_RANGE);
    this.chip.rp2040.adc.channelValues[BATTERY_CHANNEL] = Math.min(reading, ADC_RANGE - 1);
  }

  step(request) {
    const duration = request.u64();
    const counts = [request.i32(), request.i32()];
    this.setBattery(request.f32());
    this.line.feed(request.bytes());
    this.usb.feed(request.bytes());
    const start = this.end;
    this.end += duration;
    this.encoders.turn(start, this.end, counts);
    while (this.chip.nanos < this.end) {
      this.chip.run(this.end);
      if (this.chip.resetAsked) this.restart(this.chip);
    }
    const [left, right] = this.motors.takeMean(duration);
    const flags =
      (this.motors.enabled ? Flag.DRIVER_ENABLED : 0) | (this.chip.inBootLoader ? Flag.BOOT_LOADER : 0);
    const ports = [bytes(this.line.take()), bytes(this.usb.take())];
    return Buffer.concat([
      f64(left), f64(right), u32(this.resets), u8(flags), this.ticks.take(), ...ports,
    ]);
  }

  restart(last) {
    this.resets++;
    this.boot(last);
  }

  fault(kind) {
    switch (kind) {
      case Fault.NONE:
        this.chip.freeze = Freeze.NONE;
        return;
      case Fault.FREEZE:
        this.chip.freeze = Freeze.ALL;
        return;
      case Fault.FREEZE_THREAD:
        this.chip.freeze = Freeze.THREAD;
        return;
      case Fault.PANIC:
        this.chip.jump(this.panicHandler());
        return;
      case Fault.HARD_FAULT:
        this.chip.hardFault();
        return;
      case Fault.LOST_ALARMS:
        this.chip.loseAlarms();
        return;
    }
    throw new Error(`unknown fault ${kind}`);
  }

  panicHandler() {
    for (const [name, address] of this.elf.symbols) {
      if (name.includes('rust_begin_unwind')) return address;
    }
    throw new Error('the ELF file has no symbol of the panic handler; was it stripped?');
  }

  answer(request) {
    switch (request.u8()) {
      case Request.STEP:
        return this.step(request);
      case Request.POWER_CYCLE:
        this.restart(null);
        return Buffer.alloc(0);
      case Request.FAULT:
        this.fault(request.u8());
        return Buffer.alloc(0);
      case Request.USB_LINE:
        this.usb.setLine(request.i32(), request.u8() !== 0);
        return Buffer.alloc(0);
      case Request.USB_UNPLUG:
        this.usb.unplug();
        return Buffer.alloc(0);
      case Request.STACK:
        return u32(this.chip.stackHighWater(this.elf.staticEnd));
    }
    throw new Error('unknown request');
  }
}

/** Answers with what `work` returns, or with its error. */
function reply(work) {
  try {
    writeFrame(Buffer.concat([u8(OK), work()]));
    return true;
  } catch (error) {
    writeFrame(Buffer.concat([u8(FAILED), Buffer.from(error.message)]));
    return false;
  }
}

function main() {
  let emulator;
  const started = reply(() => {
    emulator = new Emulator(readElf(fs.readFileSync(process.argv[2])));
    return Buffer.alloc(0);
  });
  if (!started) return;
  for (let frame = readFrame(); frame; frame = readFrame()) {
    if (!reply(() => emulator.answer(new Reader(frame)))) return;
  }
}

main();
