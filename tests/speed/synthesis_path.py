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

# Closed paths of 120 points that no four-bar draws, with the least sum of squares, mm2, that this search has found with
# several seeds; for some of them also with twice as many curves and three times as many starts.
FULL = np.linspace(0, 2 * np.pi, 120, endpoint=False)


def polygon(*corners: complex) -> np.ndarray:
    """Points at equal distances along a closed polygon."""
    line = np.array([*corners, corners[0]])
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])
    return np.interp(np.linspace(0, length[-1], len(FULL), endpoint=False), length, line)


def harmonics(seed: int, count: int) -> np.ndarray:
    """A circle with random further harmonics."""
    rng, points = np.random.default_rng(seed), 30 * np.exp(1j * FULL)
    for n in range(2, count + 1):
        ahead, back = (complex(*rng.normal(size=2)) for _ in range(2))
        points = points + 30 / n**1.5 * (0.4 * ahead * np.exp(1j * n * FULL) + 0.5 * back * np.exp(-1j * n * FULL))
    return points


CLOSED = {
    "square": (567.064, polygon(20 + 20j, -20 + 20j, -20 - 20j, 20 - 20j)),
    "right triangle": (5.41087, polygon(0, 40, 30j)),
    "teardrop": (0.369707, 30 * np.cos(FULL) + 20j * np.sin(FULL) * np.sin(FULL / 2) ** 1.5),
    "figure eight": (198.214, 40 * np.sin(FULL) + 15j * np.sin(2 * FULL)),
    "kidney": (0.0146386, 30 * np.exp(1j * FULL) + 9 * np.exp(2j * FULL)),
    "bean": (0.101857, 30 * np.cos(FULL) + 1j * (15 * np.sin(FULL) + 10 * np.cos(FULL) ** 2)),
    "harmonics 1": (322.938, harmonics(1, 4)),
    "harmonics 2": (1180.22, harmonics(2, 4)),
    "harmonics 3": (1071.58, harmonics(3, 3)),
    "harmonics 4": (1175.64, harmonics(4, 5)),
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
    print(f"{'closed path':16}{'best known, mm2':>16}  ratio of seeds 0, 1, ... to it, and seconds")
    for name, (best, points) in CLOSED.items():
        start = time.process_time()
        ratios = [
            gk.path_generator(points, closed=True, seed=seed, time_limit=120).square_error / best
            for seed in range(min(3, seeds))
        ]
        spent = (time.process_time() - start) / len(ratios)
        print(f"{name:16}{best:16.6g}  {' '.join(f'{ratio:.4f}' for ratio in ratios)}  {spent:.1f} s", flush=True)
    for seed in range(min(3, seeds)):
        start = time.process_time()
        found = gk.path_generator(NINE, seed=seed, time_limit=120)
        spent = time.process_time() - start
        met = [one for one in found.ranked if one.square_error < 1e-16]
        sound = sum(not one.defects for one in met)
        print(f"nine points, seed {seed}: {len(met)} of 64 real linkages up to cognates, {sound} usable, {spent:.1f} s")


if __name__ == "__main__":
    figures(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
