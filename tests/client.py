"""Drives one leg through a serial device: client.py DEVICE X Y. Standard library only.
Written from protocol/PROTOCOL.md; postcard, COBS and CRC-32C by hand."""
import os, pathlib, random, select, struct, sys, time, tty

def crc32c(data, crc=0xFFFFFFFF):
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF

def cobs(data):  # no frame is long enough for a block of 254 bytes
    return b"".join(bytes([len(block) + 1]) + block for block in data.split(b"\0")) + b"\0"

def uncobs(data):
    return data[1:data[0]] + (b"\0" + uncobs(data[data[0]:]) if len(data) > data[0] > 0 else b"") if data else b""

def varint(number):
    return bytes([number]) if number < 128 else bytes([number & 127 | 128]) + varint(number >> 7)

def read_varint(data, place):
    high, end = read_varint(data, place + 1) if data[place] > 127 else (0, place + 1)
    return high << 7 | data[place] & 127, end

def send(message, sequence=None):
    number = b"\0" if sequence is None else b"\1" + varint(sequence)
    content = struct.pack("<I", session) + number + struct.pack("<HB", expected, 0) + message
    os.write(device, cobs(content + struct.pack("<I", crc32c(content))))

schema = 0xCBF29CE484222325
for byte in (pathlib.Path(__file__).parent.parent / "protocol/src/schema.txt").read_bytes():
    schema = (schema ^ byte) * 0x100000001B3 % 2**64
device = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(device)
nonce, plan, session, expected, acked = random.getrandbits(32), random.getrandbits(32), 0, 0, 0
pose, goal = struct.pack("<3f", 0, 0, 0), struct.pack("<2f", float(sys.argv[2]), float(sys.argv[3]))
leg = varint(plan) + b"\0" + pose + goal + b"\0\0\0"  # index 0; no heading, forward, limits
commands = [b"\x0a\0",  # Clear; PlanBegin with first 0, count 1 and Start; PlanLeg; PlanCommit
            b"\x04" + varint(plan) + b"\0\1" + varint(crc32c(leg)) + b"\0" + pose,
            b"\x05" + leg, b"\x06" + varint(plan)]
buffer, give_up, hello = b"", time.monotonic() + 30, b"\0\4" + varint(schema) + varint(nonce)
while time.monotonic() < give_up:
    send(b"\1" if session else hello)  # Heartbeat, or Hello
    for sequence in range(acked, len(commands) if session else 0):
        send(commands[sequence], sequence)  # again and again until acknowledged
    if select.select([device], [], [], 0.01)[0]:
        buffer += os.read(device, 4096)
    *frames, buffer = buffer.split(b"\0")
    for content in map(uncobs, frames):
        if len(content) < 13 or struct.unpack("<I", content[-4:])[0] != crc32c(content[:-4]):
            continue
        sequence, place = read_varint(content, 5) if content[4] else (None, 5)
        body = content[place + 3:-4]
        if body[0] == 0:  # Hello: version, schema, host nonce, robot nonce
            numbers, end = [], 1
            for _ in range(4):
                number, end = read_varint(body, end)
                numbers.append(number)
            if numbers[1:3] == [schema, nonce]:
                session = max(1, nonce * 0x9E3779B1 % 2**32 ^ numbers[3])
        elif struct.unpack("<I", content[:4])[0] == session:
            acked = max(acked, struct.unpack("<H", content[place:place + 2])[0])
            if sequence == expected:  # reports that come early will come again
                expected += 1
                if body[0] == 4:
                    sys.exit("refused: " + body[1:].hex())
                if body[0] == 6:  # PlanDone: the pose is its last 12 bytes
                    print("%.4f %.4f %.4f" % struct.unpack("<3f", body[-12:]))
                    sys.exit(send(b"\1"))
sys.exit("no end within half a minute")
