// USB: the chip's controller, and a host that opens its serial port.
//
// The stock controller takes an OUT buffer away from the firmware as soon as that is offered, which
// a driver reads as data that has arrived. Here the buffer stays with the firmware until the host
// has something to send; without that, the host's poll ends in a NAK, which nobody sees.

import { RPUSBController } from 'rp2040js';

const OUT_BUFFER_CONTROL = 0x84;
const LAST_BUFFER_CONTROL = 0xfc;
const AVAILABLE = 1 << 10;
const LENGTH = 0x3ff;
const PACKET = 64;

export class UsbController extends RPUSBController {
  DPRAMUpdated(offset, value) {
    const isOut = offset >= OUT_BUFFER_CONTROL && offset <= LAST_BUFFER_CONTROL && (offset & 4) !== 0;
    if (!isOut) super.DPRAMUpdated(offset, value);
    else if (value & AVAILABLE) this.onOutOffered?.((offset - OUT_BUFFER_CONTROL) >> 3);
  }

  /** Whether the firmware waits for a packet. */
  offered(endpoint) {
    return (this.rp2040.usbDPRAMView.getUint32(OUT_BUFFER_CONTROL + 8 * endpoint, true) & AVAILABLE) !== 0;
  }

  /** Gives the firmware the packet that it waits for. */
  finishRead(endpoint, packet) {
    const register = OUT_BUFFER_CONTROL + 8 * endpoint;
    const view = this.rp2040.usbDPRAMView;
    view.setUint32(register, view.getUint32(register, true) & ~AVAILABLE, true);
    super.finishRead(endpoint, packet);
  }
}

const TO_DEVICE = 0x00;
const TO_HOST = 0x80;
const TO_CLASS_INTERFACE = 0x21;
const SET_ADDRESS = 5;
const GET_DESCRIPTOR = 6;
const SET_CONFIGURATION = 9;
const SET_LINE_CODING = 0x20;
const SET_CONTROL_LINE_STATE = 0x22;
const CONFIGURATION = 2;
const ENDPOINT = 5;
const BULK = 2;
const DTR_AND_RTS = 3;

/** A host with one cable; it may be plugged in or not. */
export class UsbHost {
  constructor() {
    this.plugged = false;
    this.line = { baud: 115200, open: false };
    this.sent = [];
    this.waiting = [];
  }

  /** Wires a chip up. */
  attach(chip) {
    this.usb = chip.rp2040.usbCtrl;
    this.transfers = [];
    this.current = null;
    this.bulkIn = this.bulkOut = null;
    this.usb.onUSBEnabled = () => this.plugged && this.usb.resetDevice();
    this.usb.onResetReceived = () => this.enumerate();
    this.usb.onEndpointWrite = (endpoint, packet) => this.packetIn(endpoint, packet);
    this.usb.onOutOffered = (endpoint) => this.packetOut(endpoint);
    if (this.plugged) this.usb.resetDevice();
  }

  /** Plugs the cable in if it is not, and sets the serial port's line. */
  setLine(baud, open) {
    this.line = { baud, open };
    if (this.plugged) {
      this.control(lineCoding(baud), controlLines(open));
    } else {
      this.plugged = true;
      this.usb.resetDevice();
    }
  }

  /** Pulls the cable: nobody asks for data any more, and the chip, on its own battery, is not told. */
  unplug() {
    this.plugged = false;
    this.transfers = [];
    this.current = null;
    this.bulkIn = this.bulkOut = null;
    this.waiting = [];
  }

  enumerate() {
    const { baud, open } = this.line;
    this.transfers = [];
    this.current = null;
    this.control(
      { setup: [TO_DEVICE, SET_ADDRESS, 1, 0, 0, 0, 0, 0] },
      {
        setup: [TO_HOST, GET_DESCRIPTOR, 0, CONFIGURATION, 0, 0, 255, 0],
        done: (descriptors) => this.findEndpoints(descriptors),
      },
      { setup: [TO_DEVICE, SET_CONFIGURATION, 1, 0, 0, 0, 0, 0] },
      lineCoding(baud),
      controlLines(open),
    );
  }

  findEndpoints(descriptors) {
    for (let at = 0; at < descriptors.length; at += descriptors[at]) {
      if (descriptors[at + 1] !== ENDPOINT || descriptors[at + 3] !== BULK) continue;
      const address = descriptors[at + 2];
      if (address & TO_HOST) this.bulkIn = address & 0xf;
      else this.bulkOut = address;
    }
  }

  control(...transfers) {
    this.transfers.push(...transfers);
    if (!this.current) this.nextTransfer();
  }

  nextTransfer() {
    this.current = this.transfers.shift() ?? null;
    if (!this.current) return;
    this.current.received = [];
    this.usb.sendSetupPacket(new Uint8Array(this.current.setup));
  }

  packetIn(endpoint, packet) {
    if (endpoint === this.bulkIn) this.sent.push(...packet);
    if (endpoint !== 0 || !this.current) return;
    const { setup, received, done } = this.current;
    received.push(...packet);
    // A transfer to the device is over with its empty answer, one to the host with a short packet.
    if (setup[0] & TO_HOST && packet.length === PACKET) return;
    done?.(received);
    this.nextTransfer();
  }

  packetOut(endpoint) {
    if (endpoint === 0) {
      this.usb.endpointReadDone(0, new Uint8Array(this.current?.data ?? []));
      if (this.current) delete this.current.data;
    } else if (endpoint === this.bulkOut && this.waiting.length > 0) {
      this.usb.endpointReadDone(endpoint, new Uint8Array(this.waiting.splice(0, PACKET)));
    }
  }

  /** Sends bytes to the serial port as soon as it takes them. */
  feed(bytes) {
    const idle = this.waiting.length === 0;
    this.waiting.push(...bytes);
    if (idle && this.bulkOut !== null && this.usb.offered(this.bulkOut)) this.packetOut(this.bulkOut);
  }

  /** The bytes that the chip has sent since the last call. */
  take() {
    const sent = this.sent;
    this.sent = [];
    return sent;
  }
}

function lineCoding(baud) {
  const data = [baud & 0xff, (baud >> 8) & 0xff, (baud >> 16) & 0xff, baud >> 24, 0, 0, 8];
  return { setup: [TO_CLASS_INTERFACE, SET_LINE_CODING, 0, 0, 0, 0, data.length, 0], data };
}

function controlLines(open) {
  return { setup: [TO_CLASS_INTERFACE, SET_CONTROL_LINE_STATE, open ? DTR_AND_RTS : 0, 0, 0, 0, 0, 0] };
}
