// Length-prefixed binary frames over standard input and output, little-endian.
//
// hil_sim/src/emulator.rs is the other end and documents each frame's fields.

import fs from 'node:fs';

const STDIN = 0;
const STDOUT = 1;
const LENGTH_BYTES = 4;

/** Reads one frame; null when the other end has gone. */
export function readFrame() {
  const length = readExactly(LENGTH_BYTES);
  return length && readExactly(length.readUInt32LE(0));
}

function readExactly(count) {
  const buffer = Buffer.alloc(count);
  let filled = 0;
  while (filled < count) {
    const read = fs.readSync(STDIN, buffer, filled, count - filled, null);
    if (read === 0) return null;
    filled += read;
  }
  return buffer;
}

/** Writes one frame. */
export function writeFrame(body) {
  const length = Buffer.alloc(LENGTH_BYTES);
  length.writeUInt32LE(body.length);
  const frame = Buffer.concat([length, body]);
  let written = 0;
  while (written < frame.length) written += fs.writeSync(STDOUT, frame, written);
}

/** Takes fields off a frame, one after the other. */
export class Reader {
  constructor(buffer) {
    this.buffer = buffer;
    this.at = 0;
  }

  u8() {
    return this.buffer.readUInt8(this.skip(1));
  }

  u64() {
    return Number(this.buffer.readBigUInt64LE(this.skip(8)));
  }

  i32() {
    return this.buffer.readInt32LE(this.skip(4));
  }

  f32() {
    return this.buffer.readFloatLE(this.skip(4));
  }

  bytes() {
    const length = this.buffer.readUInt32LE(this.skip(4));
    const start = this.skip(length);
    return this.buffer.subarray(start, start + length);
  }

  skip(count) {
    const start = this.at;
    this.at += count;
    return start;
  }
}

const field = (size, write) => (value) => {
  const buffer = Buffer.alloc(size);
  buffer[write](value);
  return buffer;
};

export const u8 = field(1, 'writeUInt8');
export const u32 = field(4, 'writeUInt32LE');
export const f64 = field(8, 'writeDoubleLE');

/** Bytes behind their count. */
export function bytes(content) {
  return Buffer.concat([u32(content.length), Buffer.from(content)]);
}
