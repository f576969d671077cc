// Ring oscillator: only its random bit matters. A fixed generator gives it, so that runs repeat;
// it goes on over resets, so that two boots differ.

import { BasePeripheral } from 'rp2040js';

const CTRL = 0x00;
const STATUS = 0x18;
const RANDOMBIT = 0x1c;
const CTRL_ENABLED = 0xfab << 12;
const STATUS_STABLE = 1 << 31;
const SEED = 0x2545f491;

export class RandomBits {
  constructor() {
    this.state = SEED;
  }

  /** One bit of Marsaglia's xorshift32. */
  next() {
    this.state ^= this.state << 13;
    this.state ^= this.state >>> 17;
    this.state ^= this.state << 5;
    return this.state & 1;
  }
}

export class Rosc extends BasePeripheral {
  constructor(rp2040, name, bits) {
    super(rp2040, name);
    this.bits = bits;
  }

  readUint32(offset) {
    switch (offset) {
      case CTRL:
        return CTRL_ENABLED;
      case STATUS:
        return STATUS_STABLE;
      case RANDOMBIT:
        return this.bits.next();
    }
    return 0;
  }

  writeUint32() {}
}
