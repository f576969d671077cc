#!/usr/bin/env python3
"""A plain kinematic base for `wmr sim --lockstep HOST:PORT`: what somebody else's physics looks like.

Each step one JSON line comes, {"t": seconds, "duty": [left, right]}, and one is answered,
{"counts": [left, right], "battery": volts}. Here a wheel follows its duty with a time constant, and
the base rolls as two wheels on a common axis do. When the other end closes, the pose is printed.

    lockstep_base.py 127.0.0.1 4700
"""

import json
import math
import socket
import sys

WHEEL_RADIUS = 0.035  # m
TRACK = 0.12  # m
COUNTS_PER_TURN = 1440
NO_LOAD_SPEED = 18.0  # rad/s at full duty
TIME_CONSTANT = 0.06  # s
VOLTS = 7.4


class Base:
    def __init__(self):
        self.x = self.y = self.heading = self.time = 0.0
        self.speeds = [0.0, 0.0]  # rad/s
        self.angles = [0.0, 0.0]  # rad

    def step(self, time, duty):
        seconds, self.time = time - self.time, time
        keep = math.exp(-seconds / TIME_CONSTANT)
        rims = [0.0, 0.0]
        for wheel in (0, 1):
            goal = NO_LOAD_SPEED * max(-1.0, min(1.0, duty[wheel]))
            before = self.speeds[wheel]
            self.speeds[wheel] = goal + (before - goal) * keep
            turned = goal * seconds + (before - goal) * TIME_CONSTANT * (1.0 - keep)
            self.angles[wheel] += turned
            rims[wheel] = turned * WHEEL_RADIUS
        way, turn = (rims[0] + rims[1]) / 2.0, (rims[1] - rims[0]) / TRACK
        self.x += way * math.cos(self.heading + turn / 2.0)
        self.y += way * math.sin(self.heading + turn / 2.0)
        self.heading += turn

    def counts(self):
        return [math.floor(angle / math.tau * COUNTS_PER_TURN) for angle in self.angles]


def main(host, port):
    base = Base()
    with socket.create_connection((host, int(port))) as link:
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        with link.makefile("rw", encoding="utf-8", newline="\n") as lines:
            for line in lines:
                step = json.loads(line)
                base.step(step["t"], step["duty"])
                lines.write(json.dumps({"counts": base.counts(), "battery": VOLTS}) + "\n")
                lines.flush()
    print(json.dumps([base.x, base.y, base.heading]))


if __name__ == "__main__":
    main(*sys.argv[1:])
