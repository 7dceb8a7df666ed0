"""Times a few cases and adds them to timings.csv, so that a slowdown shows in a diff. Never pass or fail.

.venv/bin/python tests/speed/timings.py

Each is the least of many runs, which a busy machine disturbs least. The floor is the least that could be asked for: a
process that only imports NumPy, the textbook's formulas in plain NumPy, the points of a curve alone. Times of two
machines do not compare; their ratios to the floor nearly do.
"""

import csv
import datetime
import os
import platform
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from figures import as_installed, best_ms, everything, textbook

import geomkin as gk
from geomkin.tradeoff.measurement import processor

ROOT = Path(__file__).parent.parent.parent
KEPT = Path(__file__).with_name("timings.csv")
# load: of the machine while it was timed, in processes that wait or run for each core.
HEAD = ["date", "machine", "python", "numpy", "load", "case", "ms", "ratio_to_floor"]


def least_cpu_ms(*words, runs=9):
    """CPU time, all threads, of a Python process of its own that finds its bytecode."""

    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    times = []
    for _ in range(runs):
        before = spent()
        subprocess.run([sys.executable, *words], capture_output=True, check=True, env=as_installed())
        times.append(spent() - before)
    return 1000 * min(times)


def processes():
    """The command, cold, beside a process that imports NumPy."""
    floor = least_cpu_ms("-c", "import numpy")
    yield "command: --help", least_cpu_ms("-m", "geomkin", "--help"), floor
    with tempfile.TemporaryDirectory() as out:
        for name in ("spur-gear", "crank-rocker", "roller-cam"):
            recipe = str(ROOT / "recipes" / f"{name}.toml")
            for formats in ("dxf", "dxf,stl,svg,csv", ""):
                words = ["-m", "geomkin", "run", recipe, "--out", out, *(["--only", formats] if formats else [])]
                yield f"command: {name} to {formats or 'all files'}", least_cpu_ms(*words, runs=5), floor


def motions():
    """All 14 outputs of four-bars, beside the textbook's formulas."""
    local, rng = 40 + 25j, np.random.default_rng(1)
    many = [np.array(v) + rng.random(1000) for v in (100.0, 30.0, 90.0, 70.0)]

    for name, sizes, frames in (
        ("360 frames", (100.0, 30.0, 90.0, 70.0), 360),
        ("1e6 frames", (100.0, 30.0, 90.0, 70.0), 1_000_000),
        ("1000 linkages x 360 frames", many, 360),
    ):
        linkage, drive = gk.FourBar(*sizes, coupler_point=local), np.linspace(0, 2 * np.pi, frames)
        column, runs = (drive[:, None] if sizes is many else drive), (100 if frames * len(sizes) < 5000 else 7)
        ours = best_ms(lambda linkage=linkage, drive=drive: everything(gk.move(linkage, drive, speed=10.0)), runs)
        plain = best_ms(lambda sizes=sizes, column=column: textbook(sizes, local, column, 10.0), runs)
        yield f"four-bar: {name}, 14 outputs", ours, plain


def outlines():
    """Curves as chords, beside as many points of them."""
    cam = gk.load(ROOT / "recipes" / "roller-cam.toml").design
    curves = {"spur gear, 24 teeth": lambda: gk.SpurGear(24, 2).outline, "roller cam": lambda: cam.profile}
    for name, made in curves.items():
        curve = made()
        count = len(gk.flatten(curve, 0.01))
        places = np.linspace(curve.breaks[0], curve.breaks[-1], count)
        plain = best_ms(lambda curve=curve, places=places: curve.point(places), 50)
        yield f"outline: {name}, chords of 0.01 mm", best_ms(lambda made=made: gk.flatten(made(), 0.01), 50), plain


def keep(*kinds):
    """Time cases, each a name, ms and the floor's ms; print them, and add them to the file."""
    before = list(csv.DictReader(KEPT.read_text().splitlines())) if KEPT.exists() else []
    where = [datetime.date.today().isoformat(), processor(), platform.python_version(), np.__version__]
    rows = []
    for cases in kinds:
        for case, ms, floor in cases():
            load = os.getloadavg()[0] / (os.cpu_count() or 1) if hasattr(os, "getloadavg") else float("nan")
            rows.append([*where, f"{load:.1f}", case, f"{ms:.4g}", f"{ms / floor:.3g}"])
            last = [row["ms"] for row in before if row["case"] == case and row["machine"] == where[1]]
            print(f"{case:<56}{ms:10.4g} ms  {ms / floor:6.2f} x floor{f'   was {last[-1]} ms' if last else ''}")
    with KEPT.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([HEAD, *(list(row.values()) for row in before), *rows])


if __name__ == "__main__":
    keep(processes, motions, outlines)
