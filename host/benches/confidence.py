#!/usr/bin/env python3
"""How often an answer of `wmr detect` of a given confidence is right, over labelled pictures.

    python3 host/benches/confidence.py WMR SCORER DIR...        (needs numpy)

SCORER is score_photos.py, beside which photos are labelled as "arena-photo/1"; a DIR holds such photos, or scenes as
"arena-pictures/1". The arena's size alone is given. An answer is right if no true obstacle, a missed one included,
stands out of the shapes with their margins by more than 10 mm, and if the border is the labelled one. One line a
picture that is wrong, then the table.
"""
import importlib.util, json, math, pathlib, subprocess, sys

import numpy as np

RIGHT_MM = 10.0
BINS = [0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.01]


def load(path):
    sys.path.insert(0, str(pathlib.Path(path).parent))
    spec = importlib.util.spec_from_file_location("scorer", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def standing_out(scorer, grid, parts, left_out, answer):
    """The farthest point of a true obstacle outside of what is reported, millimetres."""
    found = answer.get("obstacles", [])
    margins = answer.get("margins") or [0.0] * len(found)
    covered = grid.any(grid.reported(shape, margin) for shape, margin in zip(found, margins))
    open_ = grid.any(parts) & ~left_out & ~covered
    if not open_.any():
        return 0.0
    if not covered.any():
        return math.inf
    return 1000 * float(grid.distance(covered)[open_].max())


def photos(scorer, folder):
    for path in sorted(folder.glob("*.json")):
        label = json.loads(path.read_text())
        if label.get("format") != "arena-photo/1":
            continue

        def judge(answer, code, label=label):
            verdict, named = scorer.verdict(label, answer, code)
            if named is None or label["auto"] == "refuse":
                return math.inf
            truth = scorer.Truth(label, named)
            return standing_out(scorer, truth.grid, truth.parts, truth.ignored, answer)

        yield path.parent / label["photo"], label["arena_size_m"], judge


def near_robot(grid, pose):
    if not pose:
        return np.zeros(grid.shape, bool)
    return np.hypot(grid.x[None] - pose[0], grid.y[:, None] - pose[1]) < 0.09


def scenes(scorer, folder):
    for path in sorted([*folder.glob("*.json"), *folder.glob("*/sequence.json")]):
        scene = json.loads(path.read_text())
        if scene.get("format") != "arena-pictures/1" or scene["level"] == "stereo":
            continue
        size, truth = scene["given"]["arena_size_m"], scene["truth"]
        frames = truth.get("frames") or [
            {**picture, "obstacles": truth["obstacles"],
             "robot_pose": truth["robot_pose"] if picture["robot_visible"] else None} for picture in scene["pictures"]]
        refused = scene["expected"]["action"] == "refuse" and scene["expected"].get("fault") != "goal_walled_off"
        corners = next(iter(truth["corners_px"].values())) if truth.get("corners_px") else None
        for frame in frames:

            def judge(answer, code, frame=frame):
                if refused:
                    return math.inf
                if corners:
                    off = np.linalg.norm(np.array(answer["corners_px"]) - np.array(corners), axis=1).max()
                    if off > 6:
                        return math.inf
                grid = scorer.Grid(*size)
                parts = [grid.reported(box["rect"]) for box in frame["obstacles"]]
                return standing_out(scorer, grid, parts, near_robot(grid, frame["robot_pose"]), answer)

            yield path.parent / pathlib.Path(frame["file"]).name, size, judge


def main():
    wmr, scorer, folders = sys.argv[1], load(sys.argv[2]), [pathlib.Path(folder) for folder in sys.argv[3:]]
    answers, refused = [], 0
    for photo, size, judge in (item for folder in folders for kind in (photos, scenes) for item in kind(scorer, folder)):
        answer, code = scorer.run(wmr, "detect", photo, "--arena", "{}x{}".format(*size))
        if "obstacles" not in answer:
            refused += 1
            continue
        out = judge(answer, code)
        answers.append((answer["confidence"], out))
        if out > RIGHT_MM:
            what = "wrong arena" if math.isinf(out) else f"{out:.0f} mm stand out"
            print(f"{photo.stem:28} confidence {answer['confidence']:.2f}  {what}", flush=True)
    print(f"{len(answers)} answers, {refused} refused\nconfidence     answers  right  share")
    for low, high in zip(BINS, BINS[1:]):
        outs = [out for confidence, out in answers if low <= confidence < high]
        if outs:
            right = sum(out <= RIGHT_MM for out in outs)
            print(f"{low:.2f} to {min(high, 1.0):.2f}  {len(outs):7}  {right:5}  {100 * right / len(outs):4.0f} %")


if __name__ == "__main__":
    main()
