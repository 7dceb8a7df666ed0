"""Times motions beside the least that could be asked for, and adds them to timings.csv. Never pass or fail.

.venv/bin/python tests/speed/engine.py

The floors: the textbook's formulas in plain NumPy; for chains, those of their dyads one after the other; for the
compiled engine a loop in C that writes the same outputs, where there is a compiler (gcc). CPU time, the least of many.
"""

import ctypes
import shutil
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from figures import everything, textbook
from timings import keep

sys.path.insert(0, str(Path(__file__).parent.parent.parent))  # for the linkages of the tests

import geomkin as gk
from tests.linkage.examples import locked, walking_leg
from tests.linkage.test_loops import triad

SIZES, LOCAL = (100.0, 30.0, 90.0, 70.0), 40 + 25j
SOURCE = r"""
#include <math.h>
void four_bar(long n, const double *t, double d, double a, double b, double c, double lx, double ly, double w,
              double **out, double *mu, char *closed) {
  double k = 0.5 * (b * b - c * c), zx, zy;
  lx /= b; ly /= b;
  for (long i = 0; i < n; i++) {
    double cs = cos(t[i]), sn = sin(t[i]), ux = d - a * cs, uy = -a * sn, s = ux * ux + uy * uy;
    double p = 0.5 + k / s, r2 = b * b / s - p * p, r = sqrt(r2);
    double bx = p * ux - r * uy, by = p * uy + r * ux, ax = bx - ux, ay = by - uy;
    double det = bx * ay - by * ax, dot = bx * ax + by * ay, ox = w * a * cs, oy = w * a * sn;
    double w3 = (ax * oy - ay * ox) / det, w4 = (bx * oy - by * ox) / det;
    double rx = w * ox + w3 * w3 * bx - w4 * w4 * ax, ry = w * oy + w3 * w3 * by - w4 * w4 * ay;
    double g3 = (ax * rx + ay * ry) / det, g4 = (bx * rx + by * ry) / det;
    zx = lx * bx - ly * by; zy = lx * by + ly * bx;
    out[0][2 * i] = cs; out[0][2 * i + 1] = sn; out[1][i] = w; out[2][i] = 0;
    out[3][2 * i] = bx / b; out[3][2 * i + 1] = by / b; out[4][i] = w3; out[5][i] = g3;
    out[6][2 * i] = ax / c; out[6][2 * i + 1] = ay / c; out[7][i] = w4; out[8][i] = g4;
    out[9][2 * i] = a * cs + zx; out[9][2 * i + 1] = a * sn + zy;
    out[10][2 * i] = -oy - w3 * zy; out[10][2 * i + 1] = ox + w3 * zx;
    out[11][2 * i] = -w3 * w3 * zx - g3 * zy - w * ox; out[11][2 * i + 1] = -w3 * w3 * zy + g3 * zx - w * oy;
    mu[i] = atan2(fabs(det), fabs(dot)); closed[i] = r2 >= 0;
  }
}
"""


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
    for frames, runs in ((360, 200), (10_000, 20), (1_000_000, 2)):
        drive = np.linspace(0, 2 * np.pi, frames)
        for _ in range(12):
            everything(gk.move(linkage, drive[:360], speed=10.0))
        ours, plain = side_by_side(
            lambda drive=drive: everything(gk.move(linkage, drive, speed=10.0)),
            lambda drive=drive: textbook(SIZES, LOCAL, drive, 10.0),
            runs,
        )
        yield f"engine: four-bar, {frames} frames, 14 outputs", ours, plain
    drive = np.linspace(0, 2 * np.pi, 360)
    # Made before, as a recipe's are; each moves for the first time.
    waiting = [gk.FourBar(*SIZES, coupler_point=LOCAL) for _ in range(2000)]
    for one in waiting:
        _ = one.linkage
    ours, plain = side_by_side(
        lambda: everything(gk.move(waiting.pop(), drive, speed=10.0)),
        lambda: textbook(SIZES, LOCAL, drive, 10.0),
        100,
    )
    yield "engine: four-bar, 360 frames, 14 outputs, its first motion", ours, plain


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
        for _ in range(12):
            reported(linkage, branch, point)
        ours, plain = side_by_side(lambda: reported(linkage, branch, point), flat, 100)
        yield f"engine: {name}, 360 frames, all coefficients", ours, plain


def loop_in_c(folder):
    """The four-bar's 14 outputs by a compiled loop, with room for them made anew each time; None without a compiler."""
    gcc = shutil.which("gcc")
    if gcc is None:
        return None
    source, library = folder / "loop.c", folder / "loop.so"
    source.write_text(SOURCE)
    subprocess.run([gcc, "-O3", "-march=native", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    function, number = ctypes.CDLL(str(library)).four_bar, ctypes.c_double

    def run(drive):
        out = [np.empty(len(drive), kind) for kind in "DddDddDddDDDd?"]
        places = [array.ctypes.data for array in out]
        sizes = [number(v) for v in (*SIZES, LOCAL.real, LOCAL.imag, 10.0)]
        function(
            ctypes.c_long(len(drive)), ctypes.c_void_p(drive.ctypes.data), *sizes, (ctypes.c_void_p * 12)(*places[:12]),
            ctypes.c_void_p(places[12]), ctypes.c_void_p(places[13]),
        )  # fmt: skip
        return out

    return run


def compiled():
    """The compiled engine, loaded, beside C; curves of many linkages."""
    drive = np.linspace(0, 2 * np.pi, 1_000_000)
    linkage = gk.FourBar(*SIZES, coupler_point=LOCAL)
    rng = np.random.default_rng(1)
    many = gk.FourBar(*(v + rng.random(10_000) for v in SIZES), coupler_point=LOCAL)
    turn = np.linspace(0, 2 * np.pi, 64)
    engines = ["NumPy"]
    if find_spec("numba"):
        engines.append("numba")
    with tempfile.TemporaryDirectory() as folder:
        in_c = loop_in_c(Path(folder))
        for engine in engines:
            if engine == "numba":
                import geomkin.linkage.solve.compiled  # noqa: F401
            if in_c is not None:
                check = zip(in_c(drive), everything(gk.move(linkage, drive, speed=10.0)))
                assert all(np.allclose(one, other, atol=1e-9) for one, other in check)
                ours, floor = side_by_side(
                    lambda: everything(gk.move(linkage, drive, speed=10.0)), lambda: in_c(drive), 2
                )
                yield f"engine: {engine} beside C, 1e6 frames, 14 outputs", ours, floor
            # The floor: four million points a second.
            ours = least_ms(lambda: gk.move(many, turn).point("coupler_point").position, 5)
            yield f"engine: {engine}, coupler curves of 1e4 linkages at 64", ours, 1000 * 64e4 / 4e6


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
    keep(four_bars, chains, compiled, iterated)
