#!/usr/bin/env python3
"""Compares vision with the OpenCV baseline, picture by picture, in one run on one thread.

    python3 host/benches/vision_peer.py SCENES        (the folder with baseline_opencv.py and dev/)

Needs cargo and, once, a network: it makes an environment of its own for opencv-python-headless and
numpy in target/vision_peer. The peer's time is that of its `paper` method after decoding, given the true
corners, at 300 pixels a metre; ours is that of the same steps. Least of seven runs each.
"""
import json, os, subprocess, sys, venv

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PLACE = os.path.join(ROOT, "target", "vision_peer")


def peer_python():
    python = os.path.join(PLACE, "bin", "python")
    if not os.path.exists(python):
        venv.create(PLACE, with_pip=True)
        subprocess.check_call([python, "-m", "pip", "install", "--quiet", "opencv-python-headless", "numpy"])
    return python


def bench(*words, lines=""):
    command = ["cargo", "bench", "--quiet", "-p", "wmr", "--bench", "vision", "--", *words]
    run = subprocess.run(command, cwd=ROOT, input=lines, text=True, stdout=subprocess.PIPE, check=True)
    return [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")]


def peer(scenes):
    """Runs inside the environment: one line of JSON a picture."""
    sys.path.insert(0, scenes)
    import time
    import cv2
    import baseline_opencv as base
    cv2.setNumThreads(1)
    for key, j, pic, path, _, _ in base.items(os.path.join(scenes, "dev")):
        if "frames" in j["truth"] or j["expected"]["action"] == "refuse":
            continue
        W, H = j["given"]["arena_size_m"]
        corners = base.corners_of(j, pic["camera"], False)
        image = cv2.imread(path, cv2.IMREAD_COLOR)
        times = []
        for _ in range(7):
            started = time.perf_counter()
            view, M = base.plan_view(image, corners, W, H, 300)
            base.paper(view, W, H, 300, None)
            times.append(1000 * (time.perf_counter() - started))
        line = "%s %r %r %s" % (path, W, H, " ".join("%r %r" % tuple(map(float, c)) for c in corners))
        print(json.dumps(dict(key=key, ms=min(times), line=line)))


def median(values):
    return sorted(values)[len(values) // 2]


def main():
    if sys.argv[1] == "--peer":
        return peer(sys.argv[2])
    scenes = os.path.abspath(sys.argv[1])
    text = subprocess.check_output([peer_python(), os.path.abspath(__file__), "--peer", scenes], text=True)
    theirs = [json.loads(line) for line in text.splitlines()]
    ours = bench(lines="".join(one["line"] + "\n" for one in theirs))
    groups = {}
    for peer_one, our_one in zip(theirs, ours, strict=True):
        groups.setdefault((our_one["width"], our_one["height"]), []).append((peer_one, our_one))
    print("%-10s %8s %9s %9s %6s %13s %14s" % ("pixels", "pictures", "peer ms", "paper ms", "ratio", "detect paper", "detect robust"))
    for (width, height), rows in sorted(groups.items()):
        print("%-10s %8d %9.2f %9.2f %6.2f %13.1f %14.1f" % (
            "%dx%d" % (width, height), len(rows), median([p["ms"] for p, _ in rows]),
            median([o["paper_ms"] for _, o in rows]), median([o["paper_ms"] / p["ms"] for p, o in rows]),
            median([o["detect_paper_ms"] for _, o in rows]), median([o["detect_robust_ms"] for _, o in rows])))
    ratios = [o["paper_ms"] / p["ms"] for p, o in zip(theirs, ours)]
    print("all: ratio median %.2f, greatest %.2f\n" % (median(ratios), max(ratios)))
    print("%-8s %10s %10s %10s %22s" % ("method", "megapixels", "ms", "ns/pixel", "peak bytes per pixel"))
    for one in bench("--sizes"):
        print("%-8s %10.2f %10.1f %10.2f %22.2f" % (one["method"], one["megapixels"], one["ms"], one["ns_per_pixel"], one["peak_bytes_per_pixel"]))


if __name__ == "__main__":
    main()
