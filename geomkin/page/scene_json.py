"""A scene as the JSON that the player takes."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence

import numpy as np

from ..core.errors import harmless
from ..export.still import SCREEN, kept_frames
from ..export.svg_path import path
from ..model.roles import ROLES, Role
from ..model.scene import Plot, Scene, SceneBody, SceneCurve, SceneMark, SceneRegion, shown_columns
from ..model.table import Column, significant
from ..plane.curve import AbstractCurve
from ..plane.vec import Array, Complex, Real, Whole

# Digits of places, counted from the scene's size. Fewer, and plates tremble from frame to frame on a large screen; one
# more makes a page a fifth longer.
DIGITS_OF_PLACES = 6
FARTHEST = 2**50


def island(scene: Scene, name: str) -> str:
    """The JSON text of a scene, safe within a script element."""
    text = json.dumps(scene_data(scene, name), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def scene_data(scene: Scene, name: str) -> dict[str, object]:
    """A scene as the player takes it, of plain values.

    `series` holds rows over the frames, which all else names by their index: the table's values and angles in deg as
    `floats`, places in mm as `steps`. A row that comes twice, as the angle of a body in the table, is stored once.
    """
    low, high = scene.box
    told = _Island(kept_frames(len(scene.time)), abs(high - low) or 1.0)
    scenes = [told.scene("", scene), *(told.scene(label, other) for label, other in scene.others.items())]
    data: dict[str, object] = {
        "name": harmless(name),
        "cyclic": bool(scene.cyclic),
        "frames": len(told.frames),
        "time": told._row(floats(significant(scene.time)[told.frames])),
        "scenes": scenes,
        "roles": _roles(scene),
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
    return data


def _roles(scene: Scene) -> list[dict[str, object]]:
    """The roles that a scene and those beside it use, in the order of their switches."""
    used: set[Role] = set()
    for one in (scene, *scene.others.values()):
        used |= {curve.role for curve in one.curves} | {mark.role for mark in one.marks}
        used |= {region.role for region in one.regions}
    return [{"id": role, **style._asdict()} for role, style in ROLES.items() if role in used]


class _Island:
    """What the scenes of a page share: frames, decimals, and every row of numbers and every path once."""

    def __init__(self, frames: Whole, size: float):
        self.frames, self.tolerance = frames, SCREEN * size
        self.digits = DIGITS_OF_PLACES - 1 - int(np.floor(np.log10(size)))
        self.paths: list[str] = []
        self.series: list[object] = []
        # What was stored already, as it came: plates and pins are in both assembly modes, and ends of several links.
        self._known: dict[object, int] = {}

    def plotted(self, columns: Sequence[Column], plots: Sequence[Plot]) -> dict[str, object]:
        """Columns of numbers, and the plots that show them."""
        ids = [column.id for column in columns]
        return {
            "columns": [
                {
                    "name": harmless(column.id),
                    "unit": harmless(column.unit),
                    "meaning": harmless(column.meaning),
                    "row": self._row(floats(column.written[self.frames].astype(float))),
                }
                for column in columns
            ],
            "plots": [
                {
                    "title": harmless(plot.title),
                    "columns": [ids.index(id) for id in plot.columns if id in ids],
                }
                | ({"limits": [[float(one.value), harmless(one.label)] for one in plot.limits]} if plot.limits else {})
                for plot in plots
            ],
        }

    def scene(self, label: str, scene: Scene) -> dict[str, object]:
        return {
            "label": harmless(label),
            "open": np.flatnonzero(~np.asarray(scene.assembled)[self.frames]).tolist(),
            "bodies": [self._body(body) for body in scene.bodies],
            "curves": [*map(self._region, scene.regions), *map(self._curve, scene.curves)],
            "marks": [self._mark(mark) for mark in scene.marks],
        }

    def _body(self, body: SceneBody) -> dict[str, object]:
        cut = [self._path((part.outline, *part.holes)) for part in body.parts]
        engraved = [self._path(part.marks) for part in body.parts if part.marks]
        told: dict[str, object] = {"name": harmless(body.name), "at": self._places(body.origin)}
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
        told: dict[str, object] = {"sort": mark.sort}
        # What most marks are and have is left out.
        told |= ({"label": harmless(mark.label)} if mark.label else {}) | (
            {"role": mark.role} if mark.role != "construction" else {}
        )
        told["at"] = self._places(mark.place)
        if mark.trail:
            told["trail"] = True
        if mark.vector is not None:
            told["vector"] = self._places(mark.vector)
        if mark.direction is not None:
            told["turn"] = self._angles(mark.direction)
        if mark.radius is not None:
            told["radius"] = self._row(steps(mark.radius[self.frames], self.digits))
        return told

    def _places(self, places: Complex) -> list[int]:
        places = np.asarray(places)[self.frames]
        gone = ~np.isfinite(places)
        return [self._row(steps(np.where(gone, np.nan, part), self.digits)) for part in (places.real, places.imag)]

    def _angles(self, directions: Complex) -> int:
        angles = np.angle(directions)
        known = np.isfinite(angles)
        angles[known] = np.unwrap(angles[known])
        return self._row(floats(significant(np.degrees(angles), 1.0)[self.frames]))

    def _path(self, curves: tuple[AbstractCurve, ...]) -> int:
        if curves not in self._known:
            # A digit less than places have is a twentieth of the tolerance still.
            text = path(curves, self.tolerance, self.digits - 1)
            if text not in self.paths:
                self.paths.append(text)
            self._known[curves] = self.paths.index(text)
        return self._known[curves]

    def _row(self, row: object) -> int:
        """The index of a row, which is stored once however often it comes."""
        key = json.dumps(row)
        if key not in self._known:
            self._known[key] = len(self.series)
            self.series.append(row)
        return self._known[key]


def floats(row: Real) -> object:
    """A row in single precision, seven digits of each number, as base64 of its little-endian bytes.

    One number if it is the same throughout; None if it is nan throughout.
    """
    with np.errstate(over="ignore"):
        single = row.astype("<f4")
    if not np.isfinite(single).any():
        return None
    return float(f"{row[0]:.7g}") if (single == single[0]).all() else b64encode(single.tobytes()).decode()


def steps(row: Real, decimals: int) -> object:
    """A smooth row, rounded: its decimals, then second differences in units of the last one, None for nan.

    One number if it is the same throughout; None if it is nan throughout.
    """
    known = np.isfinite(row)
    # Whole numbers that JavaScript holds exactly: what lies farther away is in no drawing.
    whole = np.clip(np.rint(row[known] * 10.0**decimals), -FARTHEST, FARTHEST).astype(np.int64)
    if not len(whole):
        return None
    if known.all() and (whole == whole[0]).all():
        return round(float(row[0]), decimals) + 0.0
    differences: Array = np.full(len(row), None)
    differences[known] = np.diff(whole, n=2, prepend=[0, 0])
    return [decimals, *differences.tolist()]
