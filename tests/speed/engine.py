"""Times motions beside the least that could be asked for, and adds them to timings.csv. Never pass or fail.

.venv/bin/python tests/speed/engine.py

The floors: the textbook's formulas in plain NumPy; for chains, those of their dyads one after the other; for
derivatives, the values. CPU time, the least of many.
"""

import sys
import time
from pathlib import Path

import numpy as np
from figures import everything, textbook
from timings import keep

sys.path.insert(0, str(Path(__file__).parent.parent.parent))  # for the linkages of the tests

import geomkin as gk
from tests.linkage.examples import locked, walking_leg
from tests.linkage.test_loops import triad

SIZES, LOCAL = (100.0, 30.0, 90.0, 70.0), 40 + 25j


def least_ms(action, runs):
    """Least CPU time of a call, warm."""
    action()
    times = []
    for _ in range(runs):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return 1000 * min(times)


def side_by_side(one, other, runs):
    """The least of two calls in turns, so that what else the machine does falls on both."""
    rounds = [(least_ms(one, runs), least_ms(other, runs)) for _ in range(5)]
    return tuple(min(times) for times in zip(*rounds))


def four_bars():
    """All 14 outputs of a four-bar that moves again and again, and of one that moves once."""
    linkage = gk.FourBar(*SIZES, coupler_point=LOCAL)
    for frames, runs in ((1, 200), (360, 200), (10_000, 20), (1_000_000, 2)):
        drive = np.linspace(0, 2 * np.pi, frames)
        ours, plain = side_by_side(
            lambda drive=drive: everything(gk.move(linkage, drive, speed=10.0)),
            lambda drive=drive: textbook(SIZES, LOCAL, drive, 10.0),
            runs,
        )
        yield f"engine: four-bar, {frames} frames, 14 outputs", ours, plain
    drive = np.linspace(0, 2 * np.pi, 360)
    rng = np.random.default_rng(1)
    ours, plain = side_by_side(
        lambda: everything(gk.move(gk.FourBar(*(SIZES + rng.random(4)), coupler_point=LOCAL), drive, speed=10.0)),
        lambda: textbook(SIZES, LOCAL, drive, 10.0),
        100,
    )
    yield "engine: four-bar, 360 frames, 14 outputs, new lengths at each call", ours, plain


def dyad(one, two, b, c, side):
    """Two bars between points that move: each point a place and its first and second derivative."""
    (p, p1, p2), (q, q1, q2) = one, two
    u = q - p
    s = u.real**2 + u.imag**2
    along = 0.5 + 0.5 * (b * b - c * c) / s
    bar = u * (along + 1j * side * np.sqrt(b * b / s - along * along))
    arm = bar - u
    across = np.conj(bar) * arm
    det = across.imag
    right = q1 - p1
    h, k = (np.conj(arm) * right).real / det, (np.conj(bar) * right).real / det
    right = q2 - p2 + h * h * bar - k * k * arm
    g, f = (np.conj(arm) * right).real / det, (np.conj(bar) * right).real / det
    angle = np.arctan2(np.abs(det), np.abs(across.real))
    return (bar / b, h, g), (arm / c, k, f), angle


def carried(base, body, local):
    """A point of a body whose pin is at its base."""
    (p, p1, p2), (turn, h, g) = base, body
    z = turn * local
    return p + z, p1 + 1j * h * z, p2 + (1j * g - h * h) * z


def chains():
    """Directions, rates and accelerations of all bodies, a point of the last one, transmission angle: longer chains."""
    drive = np.linspace(0, 2 * np.pi, 360)
    leg, six_bar = walking_leg(), gk.StephensonSixBar(gk.FourBar(*SIZES, coupler_point=LOCAL), 80, 60, 60 + 120j)

    def pinned(local):
        return np.full(drive.shape, local), np.zeros(drive.shape), np.zeros(drive.shape)

    def crank(length):
        turn = length * np.exp(1j * drive)
        return turn, 1j * turn, -turn

    def flat_leg():
        m, f = crank(15.0), pinned(-38 - 7.8j)
        upper, triangle, one = dyad(m, f, 50.0, 41.5, -1)
        lower, link, two = dyad(m, f, 61.9, 39.3, 1)
        e = carried(m, lower, 61.9)
        parallel, last, three = dyad(carried(f, triangle, 1.3 + 40.1j), e, 39.4, 36.7, -1)
        least = np.minimum(np.minimum(one, two), three)
        return upper, triangle, lower, link, parallel, last, carried(e, last, -4 + 49j), least

    def flat_six_bar():
        a = crank(30.0)
        coupler, rocker, one = dyad(a, pinned(100.0), 90.0, 70.0, 1)
        pen = carried(a, coupler, LOCAL)
        link, output, two = dyad(pen, pinned(60 + 120j), 80.0, 60.0, 1)
        return coupler, rocker, link, output, pen, np.minimum(one, two)

    def reported(linkage, branch, point):
        motion = gk.move(linkage, drive, branch)
        moved = motion.point(point)
        turns = [(b.direction, b.first, b.second) for b in motion.bodies.values()]
        return turns, moved.position, moved.first, moved.second, motion.transmission_angle

    cases = (
        ("walking leg", leg, {"B": -1, "G": -1}, "foot", flat_leg),
        ("six-bar", six_bar, 1, "coupler_point", flat_six_bar),
    )
    for name, linkage, branch, point, flat in cases:
        ours, plain = side_by_side(lambda: reported(linkage, branch, point), flat, 100)
        yield f"engine: {name}, 360 frames, all coefficients", ours, plain


def batches():
    """Curves of many linkages, and derivatives by all sizes."""
    rng = np.random.default_rng(1)
    many = gk.FourBar(*(v + rng.random(10_000) for v in SIZES), coupler_point=LOCAL)
    turn = np.linspace(0, 2 * np.pi, 64)
    # The floor: four million points a second.
    ours = least_ms(lambda: gk.move(many, turn).point("coupler_point").position, 5)
    yield "engine: coupler curves of 1e4 linkages at 64", ours, 1000 * 64e4 / 4e6

    drive = np.linspace(0, 2 * np.pi, 360)
    sizes = "ground", "crank", "coupler", "rocker", "coupler_point.x", "coupler_point.y", "ground_angle_deg"
    outputs = [f"{body}_{what}" for body in ("coupler", "rocker") for what in ("angle", "omega", "alpha")]
    outputs += ["coupler_point", "coupler_point_velocity", "coupler_point_acceleration", "transmission_angle"]

    def moved():
        return gk.move(gk.FourBar(*(SIZES + rng.random(4)), coupler_point=LOCAL), drive, speed=10.0)

    def gradients():
        motion = moved()
        return [motion.sensitivity(of, by) for of in outputs for by in sizes]

    ours, values = side_by_side(gradients, lambda: everything(moved()), 30)
    yield "engine: four-bar, 360 frames, derivatives by 7 sizes beside values", ours, values


def iterated():
    """A frame of linkages that are no chain of dyads, with the linkage made anew, beside the tenth of a ms aimed at."""
    loops, drive = locked()
    ours = least_ms(lambda: gk.move(gk.Linkage(loops.bodies, "out", estimate=loops.estimate), drive).assembled, 20)
    yield "engine: six-bar by iteration, a frame", ours / len(drive), 0.1
    bars, start, _ = triad(1)
    turn = np.linspace(start, start + 2 * np.pi, 360)
    ours = least_ms(lambda: gk.move(gk.Linkage(bars.bodies, "crank", estimate=bars.estimate), turn).assembled, 10)
    yield "engine: three bars on a plate by iteration, 360 frames of a turn, a frame", ours / len(turn), 0.1


if __name__ == "__main__":
    keep(four_bars, chains, batches, iterated)
