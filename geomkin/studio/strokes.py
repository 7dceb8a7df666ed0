"""Paths that are drawn by hand: a stroke becomes a recipe that follows it, and known linkages with similar curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..core.errors import DesignError, shown
from ..core.fields import FARTHEST
from ..core.units import UNITS
from ..linkage.measures import least_transmission_angle
from ..linkage.moving import move
from ..linkage.parts.stock import LinkStock
from ..plane.vec import Complex, Real
from ..recipe.keys import edited_text
from ..recipe.load import to_toml
from ..recipe.settings import Drive, Files
from ..synthesis.found import Rounding
from ..synthesis.kinds.linkage_goals import recipe_of, strokes_of
from ..synthesis.path.closed_lines import WantedLine
from ..synthesis.path.path import nearest_linkages
from .building import is_size, plain
from .drafts import Draft

# Most points of a stroke, and the number of points of the path that it becomes, closed or open.
MOST_DRAWN, CLOSED, OPEN = 20_000, 48, 15
# Distance of the ends of a stroke, in sizes of it, below which it is closed, and width over which it is smoothed.
NEARLY_CLOSED, SMOOTHED = 0.2, 0.012
# Bars of known linkages, and how many of each are shown.
KNOWN = {4: 2, 6: 4}
# Rounding of the sizes of known linkages, in sizes of the path.
ROUNDED = 1e-4
# Positions of a known linkage at which its path is compared; digits of the numbers of a picture.
FRAMES, DIGITS = 120, 5

HEAD = """# A linkage whose traced point follows a path that was drawn.
kind = "path-generator"

[wanted]
"""
GUIDANCE = """# A linkage that carries a body through poses that were placed.
kind = "body-guidance"

[wanted]
"""
# Poses that a recipe has at least, and decimals of their angles, deg.
LEAST_POSES, ANGLE_DIGITS = 3, 1


def stroke_points(drawn: Any) -> tuple[Complex, bool]:
    """The points of a stroke, mm, at equal distances and without the trembling of a hand, and whether it is closed.

    Raises DesignError if `drawn` is no list of at least three different places.
    """
    if not isinstance(drawn, Sequence) or not 3 <= len(drawn) <= MOST_DRAWN or not all(map(_is_place, drawn)):
        remedy = f"give 3 to {MOST_DRAWN:,} places as [x, y] in mm"
        raise DesignError("draw", f"found {shown(drawn)}", remedy, "wrong-type")
    line = np.array([complex(*place) for place in drawn])
    size = float(np.hypot(np.ptp(line.real), np.ptp(line.imag)))
    if not size > 0:
        raise DesignError("draw", "all places are the same", "draw a path", "conflict")
    is_closed = abs(line[-1] - line[0]) < NEARLY_CLOSED * size
    if is_closed:
        line = np.append(line, line[0])
    # A hand that rests trembles: places nearer than the smoothing to the last one are left out.
    kept = [line[0]]
    for place in line[1:]:
        if abs(place - kept[-1]) > SMOOTHED * size:
            kept.append(place)
    line = np.array([*kept, line[-1]])
    length, even = _evenly(line, int(np.clip(4 * _length(line)[-1] / (SMOOTHED * size), 200, 4000)), is_closed)
    width = SMOOTHED * size / length * len(even)
    reach = int(np.ceil(3 * width))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    ends = [even[-reach:], even[:reach]] if is_closed else [np.full(reach, even[0]), np.full(reach, even[-1])]
    smooth = np.convolve(np.concatenate([ends[0], even, ends[1]]), bell / bell.sum(), mode="valid")
    if is_closed:
        smooth = np.append(smooth, smooth[0])
    return _evenly(smooth, CLOSED if is_closed else OPEN, is_closed)[1], bool(is_closed)


def _length(line: Complex) -> Real:
    """Length of a line up to each of its points, mm."""
    return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])


def _evenly(line: Complex, count: int, is_closed: bool) -> tuple[float, Complex]:
    """Length of a line, and points at equal distances; of a closed one without its end."""
    length = _length(line)
    return float(length[-1]), np.interp(np.linspace(0, length[-1], count, endpoint=not is_closed), length, line)


def drawn_recipe(text: str, kind: str, units: str, drawn: Any, bars: Any = 6) -> str:
    """The text of a recipe that follows a stroke; one of the kind path-generator keeps its other keys.

    Parameters
    ----------
    text, kind, units : str
        The recipe before, its kind, and its unit of length.
    drawn : list of [x, y]
        The stroke, mm.
    bars : {4, 6, 8}
        Largest number of bars for a closed path; an open one is followed by four-bars.
    """
    points, is_closed = stroke_points(drawn)
    if bars not in (4, 6, 8):
        raise DesignError("draw", f"found {shown(bars)} bars", "give 4, 6 or 8", "out-of-range")
    unit = UNITS[units]
    size = float(np.abs(points - points.mean()).max()) / unit.mm
    digits = max(0, 3 - int(np.floor(np.log10(size))) - 1)
    rows = [[plain(round(unit.in_digits(x, "mm"), digits)) for x in (z.real, z.imag)] for z in points.tolist()]
    wanted: dict[str, Any] = {
        "wanted.points": rows,
        "wanted.closed": is_closed,
        "wanted.bars": bars if is_closed else 4,
    }
    if kind != "path-generator":
        return edited_text(_in_units(HEAD, units), wanted)
    gone = ("file", "svg", "count", "drive_deg", "step_deg", "slides")
    return edited_text(text, {**wanted, **{f"wanted.{key}": None for key in gone}, "choose": None})


def posed_recipe(draft: Draft, kind: str, units: str, poses: Any, step: Any = 0.1) -> str:
    """The text of a recipe that carries a body through poses; one of the kind body-guidance gets them after its own.

    Parameters
    ----------
    draft : Draft
        The recipe before.
    kind, units : str
        Its kind, and its unit of length.
    poses : list of [x, y, angle]
        Positions, mm, with angles in deg.
    step : float
        Size of a pixel, mm, to which positions are rounded.
    """
    if not isinstance(poses, Sequence) or not all(_is_row(pose, 3) for pose in poses):
        raise DesignError("draw", f"found {shown(poses)}", "give poses as [x, y, angle] in mm and deg", "wrong-type")
    if not is_size(step):
        raise DesignError("draw", f"found {shown(step)}", "give the size of a pixel in mm as step", "out-of-range")
    is_guidance = kind == "body-guidance"
    mm = UNITS[units].mm * (draft.scale if is_guidance else 1.0)
    digits = -int(np.floor(np.log10(step / mm)))
    rows = [
        [*(plain(round(x / mm, digits)) for x in (u, v)), plain(round(angle, ANGLE_DIGITS))] for u, v, angle in poses
    ]
    if is_guidance:
        first = len(draft.values["wanted.poses"])
        return edited_text(draft.text, {f"wanted.poses[{first + k}]": row for k, row in enumerate(rows)})
    if len(rows) < LEAST_POSES:
        raise DesignError("draw", f"found {len(rows)} poses", f"give {LEAST_POSES} or more", "out-of-range")
    return edited_text(_in_units(GUIDANCE, units), {"wanted.poses": rows})


def _in_units(text: str, units: str) -> str:
    """The start of a recipe with its unit of length."""
    return text if units == "mm" else text.replace("\n\n", f'\nunits = "{units}"\n\n', 1)


def known_linkages(drawn: Any) -> list[dict[str, Any]]:
    """Known linkages with curves similar to a closed stroke, the nearest first; none of an open one.

    Each has its recipe as `text`, a `label` with its number of bars and the largest distance of the curves as a share
    of the size and the least transmission angle, and `lines`, the strokes of its moving picture.
    """
    points, is_closed = stroke_points(drawn)
    if not is_closed:
        return []
    wanted = WantedLine.through(points)
    size = float(np.hypot(np.ptp(points.real), np.ptp(points.imag)))
    found, rounding = [], Rounding(ROUNDED, size)
    for bars, count in KNOWN.items():
        for exact, branch in nearest_linkages(points, bars, count):  # type: ignore[arg-type]
            linkage = rounding.linkage(exact)
            motion = move(linkage, np.linspace(0, 2 * np.pi, FRAMES + 1), branch)
            _, largest, _ = wanted.both_ways(motion.point("coupler_point").position)
            recipe = recipe_of(linkage, branch, (0.0, 360.0), Drive(), LinkStock(), Files())
            angle = np.degrees(least_transmission_angle(motion))
            label = f"{bars} bars, {100 * largest / size:.2g} % off, transmission angle {angle:.2g} deg"
            lines = lines_of(strokes_of(linkage, branch, (0.0, 2 * np.pi)))
            found.append((largest, {"label": label, "lines": lines, "text": to_toml(recipe)}))
    return [entry for _, entry in sorted(found, key=lambda pair: pair[0])]


def lines_of(strokes: Sequence[Complex]) -> list[list[Any]]:
    """Strokes of a small picture as plain values: each [xs, ys], of one that moves rows of them over the frames."""
    size = max((float(np.nanmax(np.abs(stroke), initial=0.0)) for stroke in strokes), default=0.0)
    decimals = DIGITS - int(np.ceil(np.log10(size or 1.0)))

    def plain_values(part: Real) -> list[Any]:
        return np.where(np.isfinite(part), np.round(part, decimals).astype(object), None).tolist()  # type: ignore[no-any-return, call-overload]

    return [[plain_values(stroke.real), plain_values(stroke.imag)] for stroke in strokes]


def _is_place(place: object) -> bool:
    return _is_row(place, 2)


def _is_row(row: object, length: int) -> bool:
    if not isinstance(row, Sequence) or isinstance(row, str) or len(row) != length:
        return False
    return all(isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= FARTHEST for x in row)
