"""Prints how many dyads of random known linkages are missed, and what a call costs. Never passes or fails.

.venv/bin/python -m tests.speed.synthesis_dyads [linkages]
"""

import sys
import time

import numpy as np

import geomkin as gk
from geomkin.synthesis.guidance.constraint import pairs_of_least, relations
from tests.synthesis.known import apart, known_linkages


def row(what, known, published, ours, ms):
    print(f"{what:<44}{known:>9}{published:>26}{ours:>26}{ms:>9}")


def known(count, poses):
    linkages = known_linkages(np.random.default_rng(poses), count, poses)
    start = time.process_time()
    found = [gk.dyads_through(one.poses) for one in linkages]
    ms = 1000 * (time.process_time() - start) / count
    off = np.array([apart(one, k, dyads) for one, dyads in zip(linkages, found) for k in (0, 1)])
    lost, worst = int(np.sum(~(off < 1e-5))), off[off < 1e-5].max()
    published = "0 of 6000 missed, 2 ms" if poses == 5 else "-"
    row(
        f"known linkages, {poses} poses, R and P joints",
        2 * count,
        published,
        f"{lost} missed, off {worst:.0e}",
        f"{ms:.2f}",
    )


def random(count):
    rng = np.random.default_rng(1)
    z = rng.normal(size=(count, 5)) + 1j * rng.normal(size=(count, 5))
    u = np.exp(1j * rng.uniform(0, 2 * np.pi, (count, 5)))
    start = time.process_time()
    _, there = pairs_of_least(relations(z, u))
    ms = 1000 * (time.process_time() - start) / count
    shares = 100 * np.bincount(there.sum(axis=1), minlength=5) / count
    ours = " ".join(f"{share:.1f}" for share in shares[[0, 2, 4]])
    row("random five poses: % with 0, 2, 4 dyads", count, "10 73 17", ours, f"{ms:.2f}")


def curves(count):
    rng = np.random.default_rng(2)
    worst, cost = 0.0, 0.0
    for _ in range(count):
        z, angle = rng.normal(size=4) + 1j * rng.normal(size=4), rng.uniform(0, 2 * np.pi, 4)
        start = time.process_time()
        found = gk.synthesis.burmester_curves(list(zip(z, angle)))
        cost += time.process_time() - start
        for piece in found.fixed:
            t = np.linspace(piece.start, piece.end, 200)
            fixed, moving = piece.point(t), piece.partner(t)
            lengths = np.abs(z + np.exp(1j * angle) * moving[:, None] - fixed[:, None])
            worst = max(worst, (np.ptp(lengths, axis=1) / (1 + abs(fixed) + abs(moving))).max())
    row("Burmester's curves of random four poses", count, "-", f"missed by {worst:.0e}", f"{1000 * cost / count:.2f}")


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    row("problem", "of", "published", "ours", "CPU ms")
    known(count // 2, 5)
    known(max(1, count // 100), 7)
    random(count)
    curves(max(1, count // 50))
