#!/usr/bin/env python3
"""Prints how well vision's answers hold up on pictures with a known truth, beyond boxes and their overlap:
corners, the robot's pose, whether margins cover the true boxes, and ways planned on the answers.

    python3 host/benches/vision_figures.py SCENES/dev        (a folder of pictures with their truth in JSON)

Standard library only; needs cargo. The format of the truth is that of `arena-pictures/1`. Overlap, missed
and invented boxes are measured by the score.py that comes with such pictures.
"""
import glob, json, math, os, statistics, subprocess, sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
WMR = os.path.join(ROOT, "target", "release", "wmr")
STEP = 0.004  # metres between the points of a true box that are looked up
COVERED = 0.001  # a point this far out is covered, metres
TOUCHING = 0.0005  # a path this much closer than the robot's radius touches, metres


def wmr(*words):
    return json.loads(subprocess.run([WMR, *words, "--json"], stdout=subprocess.PIPE, text=True).stdout)


def distance(x, y, box):
    return math.hypot(max(box[0] - x, 0, x - box[2]), max(box[1] - y, 0, y - box[3]))


def places(low, high):
    count = max(1, math.ceil((high - low) / STEP))
    return [low + (high - low) * (i + 0.5) / count for i in range(count)]


def uncovered(box, rects):
    """How far the true box sticks out of all rectangles at most, metres."""
    points = ((x, y) for x in places(box[0], box[2]) for y in places(box[1], box[3]))
    return max(min([distance(x, y, rect) for rect in rects] or [math.inf]) for x, y in points)


def clearance(path, boxes):
    points = []
    for (ax, ay), (bx, by) in zip(path, path[1:]):
        count = max(1, math.ceil(math.dist((ax, ay), (bx, by)) / STEP))
        points += [(ax + (bx - ax) * i / count, ay + (by - ay) * i / count) for i in range(count + 1)]
    return min([distance(x, y, box) for x, y in points for box in boxes] or [math.inf])


class Level:
    def __init__(self):
        self.refused = self.answered = self.open = self.no_way = self.touching = self.no_robot = 0
        self.wanted = 0
        self.corners, self.robot, self.turn, self.out, self.margins, self.longer = [], [], [], [], [], []

    def look(self, truth, picture, path, arena):
        seen = wmr("detect", path, "--arena", arena)
        if "error" in seen:
            self.refused += 1
            return
        self.answered += 1
        corners = zip(seen["corners_px"], truth["truth"]["corners_px"][picture["camera"]])
        self.corners.append(max(math.dist(a, b) for a, b in corners))
        if picture["robot_visible"]:
            self.pose(seen["robot"], truth["truth"]["robot_pose"])
        rects = [[b[0] - m[0], b[1] - m[1], b[2] + m[2], b[3] + m[3]]
                 for b, m in zip(seen["obstacles"], seen["margins"])]
        self.margins += [value for margin in seen["margins"] for value in margin]
        boxes = [box["rect"] for box in truth["truth"]["obstacles"]]
        self.out.append(max([uncovered(box, rects) for box in boxes] or [0.0]))
        self.way(truth, path, arena, boxes)

    def pose(self, seen, true):
        if seen is None:
            self.no_robot += 1
            return
        self.robot.append(1000 * math.dist(seen[:2], true[:2]))
        self.turn.append(abs(math.degrees(math.remainder(seen[2] - true[2], math.tau))))

    def way(self, truth, path, arena, boxes):
        given, length = truth["given"], truth["truth"]["path"].get("length_m")
        if not length:
            return
        ends = [",".join(map(str, given[end][:2])) for end in ("start", "goal")]
        plan = wmr("plan", path, "--arena", arena, "--start", ends[0], "--goal", ends[1])
        self.wanted += 1
        if "error" in plan:
            self.no_way += 1
            return
        points = [tuple(point[:2]) for point in plan["waypoints"]]
        self.touching += clearance(points, boxes) < given["robot_radius_m"] - TOUCHING
        self.longer.append(sum(map(math.dist, points, points[1:])) / length - 1)

    def __str__(self):
        def two(values, unit, digits):
            if not values:
                return "-"
            return f"{statistics.median(values):.{digits}f} / {max(values):.{digits}f} {unit}"
        out = sum(value > COVERED for value in self.out)
        longer = f"{100 * statistics.median(self.longer):.1f} %" if self.longer else "-"
        return "\n".join([
            f"  answered {self.answered}, refused {self.refused}",
            f"  corners, median / worst: {two(self.corners, 'px', 2)}",
            f"  robot, median / worst: {two(self.robot, 'mm', 1)}, {two(self.turn, 'deg', 1)}; not found: {self.no_robot}",
            f"  a true box sticks out of rectangles and margins in {out}, by at most {1000 * max(self.out, default=0):.0f} mm",
            f"  margin, median: {1000 * statistics.median(self.margins or [0]):.1f} mm",
            f"  ways: {self.wanted - self.no_way} of {self.wanted} found, {self.touching} touch a true box, {longer} longer than the shortest in the median",
        ])


def main():
    folder = sys.argv[1]
    subprocess.check_call(["cargo", "build", "--quiet", "--release", "-p", "wmr"], cwd=ROOT)
    levels = {}
    for name in sorted(glob.glob(os.path.join(folder, "*.json"))):
        with open(name) as file:
            truth = json.load(file)
        if "main" not in truth.get("cameras", {}) or truth["expected"]["action"] == "refuse":
            continue
        arena = "x".join(map(str, truth["given"]["arena_size_m"]))
        for picture in truth["pictures"]:
            path = os.path.join(folder, picture["file"])
            levels.setdefault(truth["level"], Level()).look(truth, picture, path, arena)
    for level, figures in levels.items():
        print(f"{level}\n{figures}")


if __name__ == "__main__":
    main()
