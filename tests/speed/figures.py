"""Prints the project's figures: start-up, vertices, time per vertex and triangle. Never pass or fail.

.venv/bin/python tests/speed/figures.py; those that are kept, to be compared later, are in timings.py.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parent.parent.parent
sys.path.insert(0, str(ROOT))  # for the exact arithmetic of the tests

import geomkin as gk  # noqa: E402


@cache
def bytecode():
    """A folder for bytecode, gone when this process ends."""
    return tempfile.TemporaryDirectory()


def as_installed():
    """Environment of a process that finds bytecode, as where a package is installed.

    Where Python is set to write none, each process compiles anew what no installation compiled: a tenth of a second.
    """
    others = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return others | {"PYTHONPYCACHEPREFIX": bytecode().name}


def cpu_ms(*command, runs=11):
    """Median CPU time (all threads) of a command as a fresh process, after one run to warm the disk."""
    times = []
    for _ in range(runs + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, capture_output=True, check=True, env=as_installed())
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return 1000 * statistics.median(times[1:])


def best_ms(action, runs=7):
    """Least time of a call, warm."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1000 * min(times)


def least_chords(curve, tolerance):
    """Greedy count of chords between points of one smooth stretch: each as long as the tolerance lets it be."""

    def error(t0, t1):
        a, b = curve.point(t0), curve.point(t1)
        z = curve.point(np.linspace(t0, t1, 300))
        return np.abs(np.imag((z - a) * np.conj(b - a))).max() / abs(b - a)

    start, last = curve.breaks[0], curve.breaks[-1]
    count = 0
    while start < last * (1 - 1e-12):
        low, high = start, last
        for _ in range(45):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if error(start, middle) <= tolerance else (low, middle)
        start, count = (last if error(start, last) <= tolerance else low), count + 1
    return count


def start_up():
    floor = cpu_ms(sys.executable, "-c", "import numpy")
    print(f"cold process, CPU ms: import numpy {floor:.0f}")
    with tempfile.TemporaryDirectory() as out:
        recipe = str(ROOT / "recipes" / "spur-gear.toml")
        for what, words in {
            "gear to DXF + STL + SVG + CSV": ["run", recipe, "--out", out],
            "gear to DXF": ["run", recipe, "--out", out, "--only", "dxf"],
            "gear to CSV": ["run", recipe, "--out", out, "--only", "csv"],
            "--help": ["--help"],
        }.items():
            cost = cpu_ms(sys.executable, "-m", "geomkin", *words)
            print(f"  {what:<32}{cost:6.0f}  {cost / floor:5.2f} x numpy")


def vertices():
    print("chords: ours, least possible (greedy), ratio")
    cam = gk.load(ROOT / "recipes" / "roller-cam.toml").cam
    for name, curve in {"involute flank, z 24 m 2": gk.SpurGear(24, 2).flank, "roller cam": cam.profile}.items():
        for tolerance in (0.1, 0.01, 0.001, 0.0001):
            if name == "roller cam" and tolerance < 0.001:
                continue  # the greedy search would take minutes
            ours = len(gk.flatten(curve, tolerance)) - (not curve.closed)
            least = least_chords(curve, tolerance)
            print(f"  {name:<26}{tolerance:8g} mm {ours:6d} {least:6d}  {ours / least:.3f}")


def files():
    from geomkin.export.cut import cut
    from geomkin.export.dxf import dxf
    from geomkin.export.layout import lay_out
    from geomkin.export.solids import stl

    n = 100_000
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    part = gk.Part("wavy", gk.plane.Polyline((50 + np.cos(40 * t)) * np.exp(1j * t)), (gk.plane.Circle(0, 5),), 3.0)
    made = cut(part, 0.005)
    sheet = lay_out([made])
    cost = best_ms(lambda: dxf(sheet), 3)
    print(f"DXF of {n} vertices: {cost:.0f} ms, {1000 * cost / n:.1f} us a vertex")
    content = []
    cost = best_ms(lambda: content.append(stl(made)), 2)
    triangles = (len(content[0]) - 84) // 50
    print(f"STL of {triangles} triangles: {cost:.0f} ms, {1000 * cost / triangles:.1f} us a triangle")


def geometry():
    print("warm calls, ms")
    print(f"  gear outline, 24 teeth, 0.01 mm: {best_ms(lambda: gk.flatten(gk.SpurGear(24, 2).outline, 0.01)):.2f}")
    cam = gk.load(ROOT / "recipes" / "roller-cam.toml").cam
    angles = np.linspace(0, 2 * np.pi, 720)
    print(f"  cam profile at 720 points:       {best_ms(lambda: cam.profile.point(angles)):.2f}")


def gears():
    from geomkin.plane.curve import Moved, SubCurve
    from geomkin.plane.flatten import smooth_runs
    from geomkin.plane.joined import Path as Joined
    from geomkin.plane.vec import Pose

    print("gears, module 2, warm: ms to make the gear and its outline as chords, and as arcs, at 0.01 mm")
    for teeth in (8, 24, 100):
        chords = best_ms(lambda teeth=teeth: gk.flatten(gk.SpurGear(teeth, 2).outline, 0.01), 50)
        arcs = best_ms(lambda teeth=teeth: gk.to_arcs(gk.SpurGear(teeth, 2).outline, 0.01), 20)
        print(f"  {teeth:4d} teeth {chords:6.2f} {arcs:6.2f}")
    print("vertices a tooth: chords, least possible (greedy from corner to corner), arcs")
    for teeth in (8, 24):
        outline = gk.SpurGear(teeth, 2).outline
        side, top, other = outline.piece.pieces
        space = Joined((other, Moved(side, Pose(0j, complex(outline.turns[1])))))
        for tolerance in (0.1, 0.01, 0.001, 0.0001):
            ours = len(gk.flatten(outline, tolerance)) // teeth
            least = sum(least_chords(SubCurve(space, run), tolerance) for run in smooth_runs(space))
            least += len(gk.flatten(top, tolerance)) - 1
            arcs = len(gk.to_arcs(outline, tolerance).vertices) // teeth
            print(f"  {teeth:4d} teeth {tolerance:8g} mm {ours:5d} {least:5d} {arcs:5d}")
    print("mates by the law of gearing, warm, ms")
    for name in ("straight-sided-external", "straight-sided-ring", "point-tooth", "lantern"):
        if (path := ROOT / "recipes" / f"{name}.toml").exists():
            print(f"  {name:<26}{best_ms(lambda path=path: gk.load(path).design, 3):6.0f}")


def cams():
    from geomkin.cam.program.optimise import optimal_polynomial, optimal_spline

    angles = np.linspace(0, 2 * np.pi, 720)
    print("cams, warm, us: profile, pressure angle and curvature at 720 angles")
    for name in ("roller-cam", "flat-cam", "rocker-cam", "flat-rocker-cam"):
        cam = gk.load(ROOT / "recipes" / f"{name}.toml").cam

        def everything(cam=cam):
            return cam.profile.point(angles), gk.pressure_angle(cam, angles), gk.plane.convexity(cam.profile, angles)

        print(f"  {name:<18}{1000 * best_ms(everything, 30):6.0f}")
    print("least peak acceleration of a rise of 2 in 90 deg: ms, peak per rad2, gap to the proven bound")
    rest, beta = (0.0, 0.0), np.pi / 2
    for name, solve in {
        "degree 7": lambda: optimal_polynomial.__wrapped__(7, 1.0, rest, rest, None),
        "degree 9": lambda: optimal_polynomial.__wrapped__(9, 1.0, rest, rest, None),
        "20 intervals": lambda: optimal_spline.__wrapped__(20, 1.0, rest, rest, None),
        "80 intervals": lambda: optimal_spline.__wrapped__(80, 1.0, rest, rest, None),
    }.items():
        best = solve()
        print(f"  {name:<14}{best_ms(solve, 3):7.1f}  {2 * best.peak_acceleration / beta**2:.4f}  {best.gap:.1e}")


def textbook(lengths, local, t, speed):
    """A four-bar as plain vectorised NumPy has it: circles that meet, then linear rates; 14 outputs.

    Direction, omega and alpha of crank, coupler and rocker; place, velocity and acceleration of a coupler point;
    transmission angle; closed.
    """
    d, a, b, c = lengths
    turn = np.exp(1j * t)
    pin = a * turn
    u = d - pin
    s = u.real**2 + u.imag**2
    p = 0.5 + 0.5 * (b * b - c * c) / s
    with np.errstate(invalid="ignore"):
        r = np.sqrt(b * b / s - p * p)
    bar = u * (p + 1j * r)
    arm = bar - u
    across = np.conj(bar) * arm
    det = across.imag
    moving = speed * pin
    omega_3, omega_4 = (np.conj(arm) * moving).imag / det, (np.conj(bar) * moving).imag / det
    right = speed * moving + omega_3**2 * bar - omega_4**2 * arm
    alpha_3, alpha_4 = (np.conj(arm) * right).real / det, (np.conj(bar) * right).real / det
    z = local / b * bar
    velocity = 1j * (moving + omega_3 * z)
    gain = (1j * alpha_3 - omega_3**2) * z - speed * moving
    angle = np.arctan2(np.abs(det), np.abs(across.real))
    crank = turn, np.full(t.shape, speed), np.zeros(t.shape)
    rest = bar / b, omega_3, alpha_3, arm / c, omega_4, alpha_4
    return *crank, *rest, pin + z, velocity, gain, angle, np.isfinite(r)


def everything(motion):
    """The same outputs of a motion."""
    point, bodies = motion.point("coupler_point"), (motion.crank, motion.coupler, motion.rocker)
    turns = [value for body in bodies for value in (body.direction, body.omega, body.alpha)]
    return *turns, point.position, point.velocity, point.acceleration, motion.transmission_angle, motion.assembled


def linkages():
    print("four-bar, warm, ns a frame: all 14 outputs, (x plain NumPy), coupler curve alone")
    sizes, local = (100.0, 30.0, 90.0, 70.0), 40 + 25j
    rng = np.random.default_rng(1)
    many = [np.array(v) + rng.random(1000) for v in sizes]
    for name, lengths, frames in (
        ("360", sizes, 360),
        ("1e4", sizes, 10_000),
        ("1e6", sizes, 1_000_000),
        ("1000 linkages x 360", many, 360),
    ):
        linkage, drive = gk.FourBar(*lengths, coupler_point=local), np.linspace(0, 2 * np.pi, frames)
        count = frames * (1000 if lengths is many else 1)
        column = drive[:, None] if lengths is many else drive
        runs = 5 if count > 1e5 else 50
        ours = best_ms(lambda: everything(gk.move(linkage, drive, speed=10.0)), runs)
        curve = best_ms(lambda: gk.move(linkage, drive).point("coupler_point").position, runs)
        plain = best_ms(lambda: textbook(lengths, local, column, 10.0), runs)
        print(f"  {name:<20}{1e6 * ours / count:7.0f}  ({ours / plain:.2f}){1e6 * curve / count:7.0f}")


def digits():
    from tests.linkage.exact import four_bar

    print("four-bar 3, 1, 4 - gap, 2 near its folded toggle: worst error in units of 2.2e-16, against 60 digits")
    print("  gap: position, velocity, acceleration")
    for power in range(0, 16, 3):
        sizes, worst = (3.0, 1.0, 4.0 - 10.0**-power, 2.0), np.zeros(3)
        for away in (0.1, 0.3, 1.0, 3.0, 10.0):
            angle = min(1.0, away * 10 ** (-power / 2))
            motion = gk.move(gk.FourBar(*sizes), [angle])
            for k, exact in enumerate(four_bar(*sizes, angle, 1)):
                what = ("direction", "first", "second")[k]
                got = [getattr(motion.bodies[b], what)[0] for b in ("coupler", "rocker")]
                worst[k] = max(worst[k], np.abs(np.array(got) - exact).max() / max(1.0, *np.abs(exact)) / 2.2e-16)
        print(f"  1e-{power:<3}", *(f"{w:6.1f}" for w in worst))


if __name__ == "__main__":
    start_up()
    vertices()
    files()
    geometry()
    gears()
    cams()
    linkages()
    digits()
