"""Prints the figures of guiding a body: how many problems are solved, in what time, and how verdicts agree.

.venv/bin/python -m tests.speed.synthesis_guidance; about three minutes. Never pass or fail. Seconds are CPU time.
"""

import time

import numpy as np

import geomkin as gk
from tests.synthesis.test_defects import BORDER, KINDS, compared
from tests.synthesis.test_guidance import poses_of, random_poses

GUIDES = ("four-bar", "crank-slider", "slider-crank", "elliptic-trammel")


def verdicts():
    print("\nVerdicts of the exact rule against driving in small steps, seeds 100 to 107")
    print(f"{'linkages':18} {'cases':>7} {'sound':>7} {'differ':>7} {'border':>7}   (border: margin below {BORDER:g})")
    total = np.zeros(4, dtype=int)
    for kind in KINDS:
        reported = np.sum([compared(kind, 2500, seed) for seed in range(100, 108)], axis=0)
        total += reported
        print(f"{kind:18} {reported[3]:7} {reported[1]:7} {reported[2]:7} {reported[0]:7}")
    print(f"{'all':18} {total[3]:7} {total[1]:7} {total[2]:7} {total[0]:7}")


def three_poses(count=50):
    print(f"\n{count} random problems of three poses: origins in a square of 100 mm, angles within the range, deg")
    print(f"{'linkage':18} {'range':>6} {'solved without defect':>22} {'seconds each':>13} {'median angle':>13}")
    for kind in GUIDES:
        for spread in (45, 180):
            rng, start, angles = np.random.default_rng(1), time.process_time(), []
            for _ in range(count):
                try:
                    best = gk.body_guides(random_poses(rng, 3, np.radians(spread)), kind)[0]
                except gk.DesignError:
                    continue
                if not best.defects:
                    angles.append(best.transmission_angle_deg)
            each = (time.process_time() - start) / count
            share, middle = 100 * len(angles) / count, np.median(angles) if angles else np.nan
            print(f"{kind:18} {spread:6} {share:20.0f} % {each:13.3f} {middle:13.1f}")


def known(count=1000):
    rng, found, cases, seconds, worst = np.random.default_rng(3), 0, 0, 0.0, 0.0
    while cases < count:
        sizes = rng.uniform(30, 100, 4)
        if 2 * sizes.max() >= sizes.sum():
            continue
        linkage = gk.FourBar(*sizes, complex(*rng.uniform(-80, 80, 2)))
        low, high = max(gk.driver_limits(linkage), key=lambda part: part[1] - part[0])
        drive = np.sort(low + (high - low) * (0.05 + 0.9 * rng.random(5)))
        poses = poses_of(linkage, drive)
        cases += 1
        start = time.process_time()
        guides = gk.body_guides(poses)
        seconds += time.process_time() - start
        off = [
            np.abs(np.array(list(guide.lengths.values())) / sizes - 1).max()
            for guide in guides
            if guide.kind == "four-bar" and not guide.defects
        ]
        found += min(off, default=1) < 1e-4
        worst = max(worst, *(guide.pose_error for guide in guides if not guide.defects))
    print(
        f"\nFive poses of {count} random known four-bars: {found} given back without defect, {seconds / count:.4f} s each"
    )
    print(f"largest distance from a pose of any linkage listed without defect: {worst:.1e} mm")


def four_poses(count=30):
    rng, better, seconds, solved = np.random.default_rng(4), 0, 0.0, 0
    for _ in range(count):
        linkage = gk.FourBar(100, 35, 90, 70, complex(*rng.uniform(-80, 80, 2)))
        drive = np.sort(rng.uniform(0.2, 5.5, 4))
        least = np.degrees(gk.least_transmission_angle(gk.move(linkage, np.linspace(drive[0], drive[-1], 500))))
        start = time.process_time()
        best = gk.body_guides(poses_of(linkage, drive), "four-bar")[0]
        seconds += time.process_time() - start
        solved += not best.defects
        better += not best.defects and best.transmission_angle_deg >= least - 0.5
    print(
        f"\nFour poses of {count} known four-bars: {solved} solved without defect, {better} as well as by the known one"
    )
    print(f"or better, {seconds / count:.2f} s each")


if __name__ == "__main__":
    verdicts()
    three_poses()
    known()
    four_poses()
