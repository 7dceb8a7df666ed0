"""Prints how well four- to eight-bars follow 32 closed curves that no four-bar draws. Never pass or fail.

.venv/bin/python -m tests.speed.synthesis_any_curve [geared] [names of curves]; five- and seven-bars if geared. Largest
distances both ways and rms, % of the diagonal of the curve's box, by position analysis of the results alone; seconds are
of the processor, of one thread. Letters need the font DejaVu Sans Bold, whose file ezdxf finds.
"""

import sys
import time

import numpy as np
from ezdxf.fonts import fonts
from fontTools.pens.recordingPen import DecomposingRecordingPen

import geomkin as gk
from geomkin.synthesis.path.curve_library import curve_library

TURN = np.linspace(0, 2 * np.pi, 800, endpoint=False)
CORNERS = np.linspace(0, 2 * np.pi, 5, endpoint=False)
KNOWN = gk.FourBar(100, 30, 90, 70, 60 + 45j)
WALKER = np.concatenate([np.linspace(-40, 40, 200), 40 * np.exp(1j * np.linspace(0, np.pi, 200))])


def corners(count: int, start: float = 0.0, inner: float = 1.0) -> np.ndarray:
    """A polygon or a star."""
    places = np.exp(1j * (start + np.pi * np.arange(2 * count) / count))
    return places * np.where(np.arange(2 * count) % 2, inner * (1.0 if inner < 1 else np.cos(np.pi / count)), 1.0)


SPIRAL = (0.3 + np.linspace(0, 1, 300)) * np.exp(4j * np.pi * np.linspace(0, 1, 300))
SHAPES = {
    "heart": 16 * np.sin(TURN) ** 3
    + 1j * (13 * np.cos(TURN) - 5 * np.cos(2 * TURN) - 2 * np.cos(3 * TURN) - np.cos(4 * TURN)),
    "star": corners(5, np.pi / 2, 0.45),
    "eight": 40 * np.sin(TURN) + 15j * np.sin(2 * TURN),
    "foot": WALKER.real + 0.6j * WALKER.imag,
    "square": corners(4),
    "triangle": corners(3),
    "bean": 30 * np.cos(TURN) + 1j * (15 * np.sin(TURN) + 10 * np.cos(TURN) ** 2),
    "spiral": np.concatenate([1.06 * SPIRAL, 0.94 * SPIRAL[::-1]]),
    "arc": np.concatenate([np.exp(1j * np.linspace(0, 2, 200)), np.exp(1j * np.linspace(2, 0, 200))]),
    "fourbar": gk.move(KNOWN, TURN).point("coupler_point").position,
}
# Effort of the searches.
EFFORT = 3
LETTERS = "AECSMWQGKXRBDFHIJLNOPT"


def letter(name: str) -> np.ndarray:
    """The outline of a capital letter."""
    font = fonts.font_manager.get_ttf_font("DejaVuSans-Bold.ttf")
    glyphs = font.getGlyphSet()
    pen = DecomposingRecordingPen(glyphs)
    glyphs[font.getBestCmap()[ord(name)]].draw(pen)
    outlines: list[list[complex]] = []
    for kind, given in pen.value:
        places = [complex(*place) for place in given]
        if kind == "moveTo":
            outlines.append(places)
        elif kind == "lineTo":
            outlines[-1].append(places[0])
        elif kind == "qCurveTo":
            for k, corner in enumerate(places[:-1]):
                end = places[-1] if k == len(places) - 2 else (corner + places[k + 1]) / 2
                t, start = np.linspace(0, 1, 9)[1:], outlines[-1][-1]
                outlines[-1] += list((1 - t) ** 2 * start + 2 * t * (1 - t) * corner + t * t * end)
    return max((np.array(line) for line in outlines), key=lambda z: abs(np.sum((np.conj(z) * np.roll(z, -1)).imag)))


def evenly(curve: np.ndarray, count: int) -> np.ndarray:
    """Points at equal distances along a closed curve."""
    line = np.append(curve, curve[0])
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])
    return np.interp(length[-1] * np.arange(count) / count, length, line)


def smooth(curve: np.ndarray) -> np.ndarray:
    """The curve with its corners rounded by a Gaussian of 1 % of its length."""
    points = evenly(curve, 1024)
    order = np.fft.fftfreq(1024, 1 / 1024)
    return np.fft.ifft(np.fft.fft(points) * np.exp(-0.5 * (2 * np.pi * order * 0.01) ** 2))


def both_ways(path: np.ndarray, curve: np.ndarray) -> tuple[float, float]:
    """Largest and rms distance, both ways, % of the curve's size, by brute force between dense points."""
    away = [
        np.array([np.abs(line - point).min() for point in evenly(points, 1024)])
        for points, line in ((path, evenly(curve, 16384)), (curve, evenly(path, 16384)))
    ]
    size = np.hypot(np.ptp(curve.real), np.ptp(curve.imag)) / 100
    return max(row.max() for row in away) / size, np.sqrt(np.mean(np.concatenate(away) ** 2)) / size


def figures(is_geared: bool, names: list[str]) -> None:
    """The table."""
    start = time.process_time()
    counts = (5, 7) if is_geared else (4, 6, 8)
    for bars in range(4, counts[-1] + 1):
        curve_library(bars)
    print(f"library of random chains: {time.process_time() - start:.1f} s")
    rows: dict[int, list[tuple[float, float, float]]] = {bars: [] for bars in counts}
    spent: list[float] = []
    for name in names:
        curve = smooth(SHAPES[name] if name in SHAPES else letter(name))
        start = time.process_time()
        limits = {"least_transmission_angle_deg": 20, "largest_ratio": 10, "time_limit": 600}
        found = gk.path_generator(curve[::4], closed=True, bars=counts[-1], geared=is_geared, effort=EFFORT, **limits)
        spent.append(time.process_time() - start)
        for bars, kept in rows.items():
            best = next(one for one in found.ranked if one.bars <= bars)
            motion = gk.move(best.linkage, np.linspace(0, 2 * np.pi, 2049)[:-1], best.branch)
            path = motion.point("coupler_point").position
            assert np.degrees(gk.least_transmission_angle(motion)) > 19.99 and best.ratio < 10.01
            kept.append((*both_ways(path, curve), best.extent))
        shown = (" / ".join(f"{value:.3g}" for value in kept[-1]) for kept in rows.values())
        print(f"{name:9}" + "".join(f"{text:>24}" for text in shown) + f"{spent[-1]:>8.0f}", flush=True)
    print("largest / rms, % of size; size of mechanism / size of curve; s of all together")
    for bars, kept in rows.items():
        largest, rms, extent = np.array(kept).T
        print(
            f"{bars} bars: largest {np.median(largest):.2f} (median), {np.percentile(largest, 80):.2f} (80th percentile),"
            f" {largest.max():.2f} (worst); rms {np.median(rms):.2f}, {np.percentile(rms, 80):.2f}, {rms.max():.2f};"
            f" size {np.median(extent):.1f}"
        )
    print(f"{np.median(spent):.0f} s (median)")


if __name__ == "__main__":
    given = [name for name in sys.argv[1:] if name != "geared"]
    figures("geared" in sys.argv[1:], given or [*SHAPES, *LETTERS])
