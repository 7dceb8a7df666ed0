"""Prints what path generation reaches on published problems, beside the best that is published. Never pass or fail.

.venv/bin/python -m tests.speed.synthesis_path [seeds]; seconds are of the processor, of one thread.
"""

import sys
import time

import numpy as np

import geomkin as gk

LENGTHS = ("ground", "crank", "coupler", "rocker")
PLACES = ("coupler_point_x", "coupler_point_y", "origin_x", "origin_y")
# Kunjur and Krishnamurty 1997: eighteen points, timed by 20 deg.
K18_X = [0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02, 0, 0, 0.03, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.6]
K18_Y = [1.1, 1.1, 1.1, 1, 0.9, 0.75, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1]
K18 = np.array(K18_X) + 1j * np.array(K18_Y)
K18_BOUNDS = dict.fromkeys(LENGTHS, (0, 50))
# Cabrera and others 2002: six points of a line, untimed, and five with times about a given pivot.
LINE6 = 20 + 1j * np.arange(20, 46, 5)
LINE6_BOUNDS = dict.fromkeys(LENGTHS, (0, 60)) | dict.fromkeys(PLACES, (-60, 60))
FIVE = np.array([3 + 3j, 2.759 + 3.363j, 2.372 + 3.663j, 1.890 + 3.862j, 1.355 + 3.943j])
FIVE_BOUNDS = {"origin_x": (0, 0), "origin_y": (0, 0), "ground_angle_deg": (0, 0), "start_deg": (30, 30)}
# Wampler, Morgan and Sommese 1992, problem 3.
NINE = np.array([0.25, 0.52 + 0.1j, 0.8 + 0.7j, 1.2 + 1j, 1.4 + 1.3j, 1.1 + 1.48j, 0.7 + 1.4j, 0.2 + 1j, 0.02 + 0.4j])

PROBLEMS = {
    "K18": ("0.0091152", K18, {"drive_deg": 20.0 * np.arange(18), "bounds": K18_BOUNDS}),
    "LINE6": ("1.96e-20", LINE6, {"bounds": LINE6_BOUNDS}),
    "FIVE": ("7.416e-7", FIVE, {"drive_deg": [30, 45, 60, 75, 90], "bounds": FIVE_BOUNDS}),
}


def figures(seeds: int) -> None:
    """The table."""
    print(f"{'problem':8}{'published':>12}{'worst':>16}{'best':>16}{'30 deg, 10':>16}{'most s':>8}  of {seeds} seeds")
    for name, (published, points, asked) in PROBLEMS.items():
        errors, usable, times = [], [], []
        for seed in range(seeds):
            start = time.process_time()
            found = gk.path_generator(points, seed=seed, time_limit=60, **asked)
            times.append(time.process_time() - start)
            moved = gk.move(found.linkage, found.drive, found.branch).point("coupler_point").position
            errors.append(np.sum(np.abs(moved - points) ** 2))
            if seed < 3:
                usable.append(found.usable.square_error if found.usable else np.nan)
        row = f"{name:8}{published:>12}{max(errors):16.9g}{min(errors):16.9g}{min(usable):16.9g}{max(times):8.2f}"
        print(row, flush=True)
    for seed in range(min(3, seeds)):
        start = time.process_time()
        found = gk.path_generator(NINE, seed=seed, time_limit=120)
        spent = time.process_time() - start
        met = [one for one in found.ranked if one.square_error < 1e-16]
        sound = sum(not one.defects for one in met)
        print(f"nine points, seed {seed}: {len(met)} of 64 real linkages up to cognates, {sound} usable, {spent:.1f} s")


if __name__ == "__main__":
    figures(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
