"""Prints how well four- to eight-bars follow 32 closed curves that no four-bar draws. Never pass or fail.

.venv/bin/python -m tests.speed.synthesis_any_curve [names of curves]; largest distances both ways and rms, % of the
diagonal of the curve's box, by position analysis of the results alone; seconds are of the processor, of one thread.
Letters need the font DejaVu Sans Bold, whose file ezdxf finds.
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
# Largest numbers of bars; five- and seven-bars are searched for together with four- and six-bars.
BARS = 4, 5, 6, 7, 8
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


def figures(names: list[str]) -> None:
    """The table."""
    start = time.process_time()
    for bars in BARS:
        curve_library(bars)
    print(f"library of random chains: {time.process_time() - start:.1f} s")
    rows: dict[int, list[tuple[float, float, float, float]]] = {bars: [] for bars in BARS}
    for name in names:
        curve = smooth(SHAPES[name] if name in SHAPES else letter(name))
        shown = []
        for bars, kept in rows.items():
            start = time.process_time()
            limits = {"least_transmission_angle_deg": 20, "largest_ratio": 10, "time_limit": 600}
            found = gk.path_generator(curve[::4], closed=True, bars=bars, geared=bars % 2 == 1, **limits)
            spent = time.process_time() - start
            motion = gk.move(found.linkage, np.linspace(0, 2 * np.pi, 2049)[:-1], found.branch)
            path = motion.point("coupler_point").position
            assert np.degrees(gk.least_transmission_angle(motion)) > 19.99 and found.ratio < 10.01
            kept.append((*both_ways(path, curve), found.extent, spent))
            shown.append(" / ".join(f"{value:.3g}" for value in kept[-1]))
        print(f"{name:9}" + "".join(f"{text:>30}" for text in shown), flush=True)
    print("largest / rms, % of size; size of mechanism / size of curve; s")
    for bars, kept in rows.items():
        largest, rms, extent, spent = np.array(kept).T
        print(
            f"{bars} bars: largest {np.median(largest):.2f} (median), {np.percentile(largest, 80):.2f} (80th percentile),"
            f" {largest.max():.2f} (worst); rms {np.median(rms):.2f}, {np.percentile(rms, 80):.2f}, {rms.max():.2f};"
            f" size {np.median(extent):.1f}; {np.median(spent):.1f} s"
        )


if __name__ == "__main__":
    figures(sys.argv[1:] or [*SHAPES, *LETTERS])
