"""A scene as the data that the player takes: numbers rounded, and told by how they change, which is short."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from ..errors import harmless
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Mask, Real, Whole, rounded
from ..scene import Plot, Scene, SceneBody, SceneCurve, SceneMark, SceneRegion
from ..table import Column
from .path import path

# Distance between an outline and its chords, as a share of the scene's size. More, and corners show on a wide screen;
# a tenth of it, and a gear's page is three times as long.
SCREEN = 2e-4
# Digits of places, counted from the scene's size. Fewer, and plates tremble from frame to frame on a large screen; one
# more makes a page a fifth longer.
DIGITS_OF_PLACES = 6
# Decimals of angles in deg, of bodies as of the table. Fewer, and plates tremble from frame to frame on a large screen.
ANGLES = 4
# Digits that arrows and centres, of which nobody reads more than a direction and a size, have less than places.
ROUGH, ROUGHLY = 2, ("velocity", "acceleration", "centre")
# Digits of the table's values, counted from the largest of a column: as many as anybody reads off a plot.
DIGITS_OF_VALUES = 6
# Frames of a page at most, evenly chosen. More make no smoother picture and a page of megabytes; fewer would leave
# out frames of a full turn in half degrees.
MOST_FRAMES = 1001
# Of six bits each, in the order of base 64.
SIGNS = np.frombuffer(b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", dtype=np.uint8)
# How often differences are taken at most: what smooth motion leaves after three times is rounding, which grows with
# each one more.
MOST_TIMES = 3
# The most low bits that every number is told with. More are for numbers that jump about, of which there are few.
MOST_ORDER = 5


def kept_frames(frames: int) -> Whole:
    """Which of so many frames a page shows, both ends included."""
    return np.rint(np.linspace(0, frames - 1, min(frames, MOST_FRAMES))).astype(np.intp)


def shown_columns(scene: Scene) -> list[Column]:
    """The columns of the table that hold numbers."""
    return [column for column in scene.table.columns if np.asarray(column.values).dtype.kind in "fiub"]


def island(scene: Scene, name: str) -> str:
    """The JSON text of a scene, safe within a script element.

    `series` holds rows over the frames as `packed` tells them, which all else names by their index. Angles are in deg,
    places in mm. A row that comes twice, as the angle of a body in the table, is told once.
    """
    low, high = scene.box
    told = _Island(kept_frames(len(scene.time)), abs(high - low) or 1.0)
    scenes = [told.scene("", scene), *(told.scene(label, other) for label, other in scene.others.items())]
    data: dict[str, object] = {
        "name": harmless(name),
        "cyclic": bool(scene.cyclic),
        "frames": len(told.frames),
        "time": told.values(scene.time),
        "scenes": scenes,
        **told.plotted(shown_columns(scene), scene.plots),
        "paths": told.paths,
        "series": told.series,
    }
    if scene.choice is not None:
        # A row for each that there was to choose from, all of which are told.
        rows = scene.choice.table
        own = _Island(np.arange(len(rows.columns[0].values)), 1.0)
        data["choice"] = {
            **own.plotted(rows.columns, scene.choice.plots),
            "frames": len(own.frames),
            "chosen": scene.choice.chosen,
            "series": own.series,
        }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


class _Island:
    """What the scenes of a page share: frames, decimals, and every row of numbers and every path once."""

    def __init__(self, frames: Whole, size: float):
        self.frames, self.tolerance = frames, SCREEN * size
        self.digits = DIGITS_OF_PLACES - 1 - int(np.floor(np.log10(size)))
        self.paths: list[str] = []
        self._rows: dict[str, int] = {}
        # What was told already, as it came: plates and pins are in both assembly modes, and ends of several links.
        self._known: dict[object, int] = {}

    @property
    def series(self) -> list[str]:
        return list(self._rows)

    def plotted(self, columns: Sequence[Column], plots: Sequence[Plot]) -> dict[str, object]:
        """Columns of numbers, and the plots that show them."""
        headers = [column.header for column in columns]
        return {
            "columns": [
                {
                    "name": harmless(column.name),
                    "unit": harmless(column.unit),
                    "meaning": harmless(column.meaning),
                    "row": self.values(np.asarray(column.values, dtype=float), column.scale, column.unit),
                }
                for column in columns
            ],
            "plots": [
                {
                    "title": harmless(plot.title),
                    "columns": [headers.index(header) for header in plot.columns if header in headers],
                }
                | ({"limits": [[float(one.value), harmless(one.label)] for one in plot.limits]} if plot.limits else {})
                for plot in plots
            ],
        }

    def scene(self, label: str, scene: Scene) -> dict[str, object]:
        return {
            "label": harmless(label),
            "open": np.flatnonzero(~np.asarray(scene.closed)[self.frames]).tolist(),
            "bodies": [self._body(body) for body in scene.bodies],
            "curves": [*map(self._region, scene.regions), *map(self._curve, scene.curves)],
            "marks": [self._mark(mark) for mark in scene.marks],
        }

    def _body(self, body: SceneBody) -> dict[str, object]:
        cut = [self._path((part.outline, *part.holes)) for part in body.parts]
        engraved = [self._path(part.marks) for part in body.parts if part.marks]
        told: dict[str, object] = {"name": harmless(body.name), "at": self._places(body.origin, self.digits)}
        told |= {"turn": self._angles(body.direction), "layer": body.layer, "cut": cut}
        told |= {} if body.named else {"unnamed": True}
        return told | ({"fixed": True} if body.fixed else {}) | ({"engraved": engraved} if engraved else {})

    def _curve(self, curve: SceneCurve) -> dict[str, object]:
        drawn = self._path((curve.curve,))
        told: dict[str, object] = {"path": drawn, "role": curve.role, "label": harmless(curve.label)}
        return told | ({"body": harmless(curve.body)} if curve.body else {})

    def _region(self, region: SceneRegion) -> dict[str, object]:
        return {"path": self._path(region.curves), "role": region.role, "label": harmless(region.label)}

    def _mark(self, mark: SceneMark) -> dict[str, object]:
        digits = self.digits - ROUGH * (mark.role in ROUGHLY)
        told: dict[str, object] = {"sort": mark.sort}
        # What most marks are and have is left out.
        told |= ({"label": harmless(mark.label)} if mark.label else {}) | (
            {"role": mark.role} if mark.role != "construction" else {}
        )
        told["at"] = self._places(mark.place, self.digits if mark.vector is not None else digits)
        if mark.trail:
            told["trail"] = True
        if mark.vector is not None:
            told["vector"] = self._places(mark.vector, digits)
        if mark.direction is not None:
            told["turn"] = self._angles(mark.direction)
        if mark.radius is not None:
            told["radius"] = self._row(mark.radius, self.digits)
        return told

    def values(self, row: Real, scale: float = 0.0, unit: str = "") -> int:
        """Of the table, to as many digits as its largest value asks for; angles and places as those of bodies if that
        is one less at most.
        """
        largest = max(scale, float(np.abs(row[np.isfinite(row)]).max(initial=0.0)))
        digits = DIGITS_OF_VALUES - 1 - int(np.floor(np.log10(largest))) if largest > 0 else 0
        if unit == "deg" and ANGLES - 2 <= digits <= ANGLES:
            digits = ANGLES
        if unit == "mm" and digits == self.digits + 1:
            digits = self.digits
        return self._row(row, min(digits, 290))

    def _places(self, places: Complex, digits: int) -> list[int]:
        places = np.asarray(places)
        gone = ~np.isfinite(places)
        return [self._row(np.where(gone, np.nan, part), digits) for part in (places.real, places.imag)]

    def _angles(self, directions: Complex) -> int:
        angles = np.angle(directions)
        known = np.isfinite(angles)
        angles[known] = np.unwrap(angles[known])
        return self._row(np.degrees(angles), ANGLES)

    def _path(self, curves: tuple[AbstractCurve, ...]) -> int:
        if curves not in self._known:
            # A digit less than places have is a twentieth of the tolerance still.
            text = path(curves, self.tolerance, self.digits - 1)
            if text not in self.paths:
                self.paths.append(text)
            self._known[curves] = self.paths.index(text)
        return self._known[curves]

    def _row(self, row: Real, digits: int) -> int:
        """The index of a row, which is told once however often it comes."""
        kept = np.asarray(row, dtype=float)[self.frames]
        key = kept.tobytes(), digits
        if key not in self._known:
            self._known[key] = self._rows.setdefault(packed(kept, digits), len(self._rows))
        return self._known[key]


def packed(row: Real, decimals: int) -> str:
    """A row (n,), rounded to `decimals`, as a text: "decimals times order runs signs"; or the one number that all is.

    Taken as whole numbers of the last decimal, they are replaced by the differences to the one before, so many times.
    Each difference d is then told as 2 d, or as -2 d - 1 below 0, by the Exp-Golomb code of the order, as in video;
    signs hold these bits, six each, the highest first. runs: how many numbers are known, then how many are nan, in
    turns with commas between; nothing where all are known.
    """
    known = np.isfinite(row)
    exact = rounded(row[known], decimals)
    if known.all() and len(exact) and (exact == exact[0]).all():
        return f"{exact[0]:.12g}"
    whole = np.rint(exact * 10.0**decimals if decimals >= 0 else exact / 10.0**-decimals).astype(np.int64)
    tried = [whole]
    for _ in range(MOST_TIMES):
        tried.append(tried[-1].copy())
        tried[-1][1:] -= tried[-2][:-1]
    folded = np.array([np.where(values < 0, -2 * values - 1, 2 * values) for values in tried])
    times = int(np.argmin(_sizes(folded, 1).sum(axis=1)))
    orders = np.arange(MOST_ORDER + 1)
    order = int(np.argmin(_sizes(folded[times], orders[:, None]).sum(axis=1)))
    runs = "" if known.all() else _runs(known)
    return f"{decimals} {times} {order} {runs} {_signs(folded[times], order)}"


def _sizes(values: Whole, order: Whole | int) -> Whole:
    """Bits that the code of the order takes for each number from 0."""
    exponents: Whole = np.frexp((values + np.left_shift(1, order)).astype(float))[1].astype(np.int64)
    return 2 * exponents - 1 - order


def _signs(values: Whole, order: int) -> str:
    """All numbers in a row: each with the bit of the order added, zeros before it for the bits beyond the order."""
    sizes = _sizes(values, order)
    # A row for each bit: its number, and how many bits of it come after. What stands before a number is zeros.
    after = np.repeat(np.cumsum(sizes), sizes) - np.arange(1, sizes.sum() + 1)
    bits = np.repeat(values + (1 << order), sizes) >> np.minimum(after, 62) & 1
    bits = np.concatenate([bits, np.zeros(-len(bits) % 6, dtype=bits.dtype)])
    return SIGNS[bits.reshape(-1, 6) @ (1 << np.arange(5, -1, -1))].tobytes().decode()


def _runs(known: Mask) -> str:
    """Lengths of runs, the first of known numbers, be it of none."""
    edges = np.flatnonzero(np.diff(known, prepend=True, append=not known[-1]))
    return ",".join(map(str, np.diff(edges, prepend=0)))
