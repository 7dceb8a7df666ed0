"""Prints the project's figures: start-up, vertices, time per vertex and triangle. Never pass or fail.

.venv/bin/python tests/speed/figures.py
"""

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import geomkin as gk

ROOT = Path(__file__).parent.parent.parent


def cpu_ms(*command, runs=11):
    """Median CPU time (all threads) of a command as a fresh process, after one run to warm the disk."""
    times = []
    for _ in range(runs + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, capture_output=True, check=True)
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
    from geomkin.export.stl import stl

    n = 100_000
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    part = gk.Part("wavy", gk.Polyline((50 + np.cos(40 * t)) * np.exp(1j * t)), (gk.Circle(0, 5),), 3.0)
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
    linkage, drive = gk.FourBar(100, 30, 90, 70, 40 + 25j), np.linspace(0, 2 * np.pi, 10_000)
    cost = best_ms(lambda: gk.move(linkage, drive))
    print(f"  four-bar, 1e4 frames:            {cost:.2f}  ({1e6 * cost / 1e4:.0f} ns a frame)")


if __name__ == "__main__":
    start_up()
    vertices()
    files()
    geometry()
