"""Views and tables of a drawing besides the front view: half sections, and data of holes, gears and cams."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..core.errors import harmless
from ..core.records import record
from ..core.units import MM, LengthUnit
from ..model.part import FitLimits, HoleFit, Part
from ..plane.curve import Moved
from ..plane.flatten import flatten
from ..plane.joined import PolarArray
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, Real
from .cut import Cut, Loop
from .dimensions import AWAY, CENTRE, DIM, LETTER, LINE, OVER, PART, DrawingCanvas, length_text, without_noise
from .job import Job
from .text import width_of

# Steps, deg, of the table of a profile: the first one from which a cubic curve stays within the tolerance.
STEPS_DEG = (10, 5, 3, 2, 1)


def profile_table(
    job: Job, part: Part, curve: Any, datum: complex, pitches: int = 1
) -> tuple[list[Sequence[str]], str]:
    """The table of a curve by polar coordinates, or by points if no smooth curve through radii is within the tolerance.

    Of a curve with equal pitches, such as teeth, it has the points of one.
    """
    unit, tolerance = job.unit, job.tolerance
    dense = without_noise(flatten(curve, tolerance / 10) - datum)
    dense = dense[np.abs(dense - np.roll(dense, 1)) > 1e-9 * np.abs(dense).max()]
    piece = curve.count if isinstance(curve, PolarArray) else pitches
    angle = np.unwrap(np.angle(dense))
    angle = angle if angle[-1] > angle[0] else -angle
    if not (piece == 1 and np.all(np.diff(angle) > 0) and abs(angle[-1] - angle[0]) > np.pi):
        return _point_table(job, curve, datum, piece)
    order = np.argsort(np.mod(np.angle(dense), 2 * np.pi))
    theta, radius = np.mod(np.angle(dense), 2 * np.pi)[order], np.abs(dense)[order]
    fine = np.radians(np.arange(0, 360, 0.25))
    exact = np.interp(fine, theta, radius, period=2 * np.pi)
    for step in STEPS_DEG:
        deviation = float(np.abs(_cubic(exact[:: 4 * step], 4 * step) - exact).max())
        if deviation <= tolerance:
            break
    else:
        # No cubic curve follows a corner.
        return _point_table(job, curve, datum, piece)
    lift = _lifts(job, part, step)
    heading = ["angle", "radius", *(["lift"] if lift else [])]
    rows: list[Sequence[str]] = [heading]
    for k, value in enumerate(exact[:: 4 * step].tolist()):
        rows.append([str(k * step), length_text(value, unit), *([lift[k]] if lift else [])])
    follower = " lift by the rotation of the cam, deg;" if lift else ""
    return rows, (
        f"radius of the profile by the angle from x, counterclockwise, deg;{follower}"
        f" a cubic curve through the rows is within {unit.of(deviation):.2g}"
    )


def _point_table(job: Job, curve: Any, datum: complex, pitches: int) -> tuple[list[Sequence[str]], str]:
    """Corners of chords within the tolerance, of a curve with equal pitches those of one from end to end."""
    unit = job.unit
    points = without_noise(flatten(curve, job.tolerance) - datum)
    if pitches > 1:
        points = points[: len(points) // pitches + 1]
    rows: list[Sequence[str]] = [("point", "x", "y")]
    rows += [
        (str(k), *(length_text(value, unit) for value in (point.real, point.imag)))
        for k, point in enumerate(points.tolist())
    ]
    turns = f", one of {pitches} equal pitches around the datum" if pitches > 1 else ""
    return rows, (
        f"profile: points of the table, x and y from the datum{turns}; straight lines between them are within "
        f"{unit.of(job.tolerance):.2g}"
    )


def _cubic(radius: Real, between: int) -> Real:
    """Values between equally spaced ones around a turn: cubic curves through the four nearest."""
    t = np.arange(between) / between
    a, b, c, d = (np.roll(radius, shift)[:, None] for shift in (1, 0, -1, -2))
    value = (
        -t * (t - 1) * (t - 2) / 6 * a
        + (t + 1) * (t - 1) * (t - 2) / 2 * b
        - (t + 1) * t * (t - 2) / 2 * c
        + (t + 1) * t * (t - 1) / 6 * d
    )
    return np.asarray(value.ravel(), dtype=float)


def _lifts(job: Job, part: Part, step: int) -> list[str]:
    """Lift of the follower at cam angles by a step, deg, if the table of the motion has it."""
    table = job.source.table
    ids = [column.id for column in table.columns] if table else []
    if table is None or part.name != "cam" or "lift" not in ids or ids[0] != "cam_angle":
        return []
    column = table.column("lift")
    angle, lift = (np.asarray(c.values, dtype=float) for c in (table.columns[0], column))
    values = np.interp(np.arange(0, 360, step), np.mod(angle, 360.0), lift, period=360.0)
    return [f"{value:.4f}".rstrip("0").rstrip(".") + ("" if column.unit == job.unit.name else "°") for value in values]


# Forms of holes by their number of flats.
FORMS = {1: "D Ø", 2: "double D Ø", 4: "square over corners Ø", 6: "hexagonal over corners Ø"}


def hole_size(fit: HoleFit | None, diameter: float | None, unit: LengthUnit) -> str:
    """Width and purpose of a hole; `diameter` is that of a round one as drawn, mm."""
    if fit is None:
        return f"Ø{length_text(diameter or 0.0, unit)}"
    width = length_text(fit.diameter + fit.play if diameter is None else diameter, unit)
    sizes = [f"Ø{width}"]
    if fit.travel:
        sizes = [f"slot {width} wide", f"({length_text(fit.travel + fit.diameter + fit.play, unit)} long)"]
    if fit.flat:
        across = "across flat" if fit.flats == 1 else "between flats"
        sizes = [f"{FORMS[fit.flats]}{width}", f"{across} {length_text(fit.flat, unit)}"]
    if any(fit.keyway):
        sizes.append("keyway {} wide {} deep".format(*(length_text(size, unit) for size in fit.keyway)))
    if (limits := fit.limits) is not None:
        hole, _, shaft = fit.iso_fit.partition("/")
        sizes[0] = sizes[0].replace(width, f"{length_text(fit.diameter, unit)} {hole} {_deviations(limits.hole, unit)}")
        kinds = (f"shaft {shaft} {_deviations(limits.shaft, unit)}", _clearances(limits, unit)) if shaft else ()
        return ", ".join([*sizes, *kinds])
    if not fit.play:
        return ", ".join(sizes)
    kind = "press" if fit.is_press or fit.play < 0 else "clearance"
    return f"{', '.join(sizes)} ({length_text(fit.diameter, unit)}, {kind} {unit.of(fit.play):+.5g})"


def _deviations(deviations: tuple[float, float], unit: LengthUnit) -> str:
    """Upper and lower deviation of a size, mm, in a unit, as usual in drawings."""
    low, high = (f"{unit.of(value):+.4f}" if unit is MM else f"{unit.of(value):+.5f}" for value in deviations)
    return "({}/{})".format(*("0" if float(text) == 0 else text.rstrip("0") for text in (high, low)))


def _clearances(limits: FitLimits, unit: LengthUnit) -> str:
    """The least and the largest clearance of a fit in words; negative ones are interferences."""
    least, largest = (f"{unit.of(value):+.4g}" for value in (limits.least_clearance, limits.largest_clearance))
    return f"clearance {least} to {largest}"


@record(eq=False)
class GearData:
    """Data of a gear by name, its teeth, pitch radius, mm, and whether its flanks are involutes, which data define."""

    rows: tuple[tuple[str, str], ...]
    teeth: int
    pitch_radius: float
    is_involute: bool


def gear_data(job: Job, part: Part) -> GearData | None:
    """The data of a gear as in ISO 1340, or of a wheel of a belt or chain; None for other parts."""
    measures, wheel = (_notes_of(job, part, key) for key in (f"measures_{job.unit.name}", "wheels"))
    if "teeth" in measures:
        pitch = measures["pitch_radius"] * job.unit.mm
        return GearData(tuple(_involute_data(job, part, measures)), measures["teeth"], pitch, True)
    if "teeth" in wheel:
        pitch = wheel[f"pitch_diameter_{job.unit.name}"] / 2 * job.unit.mm
        return GearData(tuple(_wheel_data(job, part, wheel)), wheel["teeth"], pitch, False)
    return None


def _involute_data(job: Job, part: Part, measures: Mapping[str, Any]) -> list[tuple[str, str]]:
    helix = _notes_of(job, part, "helix")

    def size(value: float) -> str:
        return length_text(value * job.unit.mm, job.unit)

    def toleranced(measure: Mapping[str, Any]) -> str:
        low, high = sorted((0.0, measure.get("tolerance", 0.0)))
        limits = _deviations((low * job.unit.mm, high * job.unit.mm), job.unit) if low or high else ""
        return f"{size(measure['measure'])} {limits}".strip()

    name = job.unit.name
    rows = [
        ("teeth", str(measures["teeth"])),
        ("transverse module" if helix else "module", size(measures["module"])),
        ("pressure angle", f"{measures['pressure_angle_deg']:.6g}°"),
    ]
    if helix:
        rows += [
            ("helix angle", f"{helix['helix_angle_deg']:.6g}°"),
            ("hand", f"{helix['hand']}{', herringbone' if helix['herringbone'] else ''}"),
            ("normal module", size(helix[f"normal_module_{name}"])),
            ("normal pressure angle", f"{helix['normal_pressure_angle_deg']:.6g}°"),
            ("lead", size(helix[f"lead_{name}"])),
        ]
    rows.append(("profile shift coefficient", f"{measures['profile_shift']:.6g}"))
    rows.append(("tooth thickness, pitch circle", size(measures["tooth_thickness"])))
    # Involute outlines have a tooth along y, in the frame in which they are drawn.
    placed = part.outline.pose.direction if isinstance(part.outline, Moved) else 1.0
    rows.append(("middle of a tooth, from x", f"{float(np.degrees(np.angle(1j * placed))) % 360:.6g}°"))
    for circle in ("tip", "pitch", "base", "root"):
        # The tip circle of an outline has its diameter in the view.
        if f"{circle}_radius" in measures and (circle != "tip" or isinstance(part.outline, Circle)):
            rows.append((f"{circle} dia", size(2 * measures[f"{circle}_radius"])))
    if span := measures.get("span"):
        rows.append((f"span over {span['teeth']} teeth", toleranced(span)))
    for key, words in (("over_pins", "over"), ("between_pins", "between")):
        if pins := measures.get(key):
            rows.append((f"{words} pins of dia {size(pins['pin_diameter'])}", toleranced(pins)))
    tool = "pinion cutter" if "tool_teeth" in measures else "rack cutter"
    if "tool_teeth" in measures:
        shift = f", profile shift {measures['tool_profile_shift']:.6g}" if measures["tool_profile_shift"] else ""
        rows.append((f"teeth of the {tool}", f"{measures['tool_teeth']}{shift}"))
    for key, words in (("tip", "tip radius"), ("fillet", "fillet at the root")):
        if f"tool_{key}_radius" in measures:
            rows.append((f"{words} of the {tool}", size(measures[f"tool_{key}_radius"])))
    rows += [(key.replace("_", " "), size(measures[key])) for key in ("tip_rounding", "tip_chamfer") if key in measures]
    return [*rows, *_mates(job, part), ("accuracy class", harmless(job.title.general_tolerance or "not stated"))]


def _mates(job: Job, part: Part) -> Iterator[tuple[str, str]]:
    """The gears that mesh with a gear, with their teeth and centre distances."""
    notes, local = _notes(job, part)
    measures = notes.get(f"measures_{job.unit.name}", {})
    for key, mesh in notes.items():
        distance = mesh.get(f"centre_distance_{job.unit.name}") if isinstance(mesh, Mapping) else None
        if distance is None:
            continue
        gears = key.split("_and_") if "_and_" in key else list(measures)
        if key.startswith("stage_"):
            gears = [f"{side}_{key.removeprefix('stage_')}" for side in ("driver", "driven")]
        if local in gears and len(gears) == 2:
            (mate,) = (name for name in gears if name != local)
            teeth = f", {measures[mate]['teeth']} teeth" if mate in measures else ""
            yield "mate", f"{harmless(mate)}{teeth}"
            yield "centre distance", length_text(distance * job.unit.mm, job.unit)


def _wheel_data(job: Job, part: Part, wheel: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Teeth and diameters of a sprocket or a toothed pulley, with the profile of its chain or belt."""
    notes, _ = _notes(job, part)
    medium: Any = next((notes[key] for key in ("belt", "chain") if key in notes), {})
    yield "teeth", str(wheel["teeth"])
    yield "profile", str(medium.get("profile", ""))
    for words in ("pitch", "outer"):
        if f"{words}_diameter_{job.unit.name}" in wheel:
            yield f"{words} dia", length_text(wheel[f"{words}_diameter_{job.unit.name}"] * job.unit.mm, job.unit)


def _notes(job: Job, part: Part) -> tuple[Mapping[str, Any], str]:
    """The notes with data of a part, and its name in them: of a machine those of the part's mechanism."""
    mechanisms: Any = job.notes.get("mechanisms", {})
    for name, notes in mechanisms.items():
        if part.name.startswith(f"{name}_"):
            return notes, part.name.removeprefix(f"{name}_")
    return job.notes, part.name


def _notes_of(job: Job, part: Part, key: str) -> Mapping[str, Any]:
    """Notes on a part, by its name, or for the first part if the notes have a single entry."""
    notes, local = _notes(job, part)
    entries = notes.get(key)
    if not isinstance(entries, Mapping):
        return {}
    prefix = part.name.removesuffix(local)
    is_first = part is next(p for p in job.source.parts if p.name.startswith(prefix))
    entry = entries.get(local, entries if is_first else None)
    return entry if isinstance(entry, Mapping) else {}


# Distances of the lines of a hatching along the axis, and of the lines that show the direction of teeth, mm on paper.
HATCHED, TEETH_APART = 2.5, 2.0
# Points of a line that shows the direction of teeth, along the face.
ALONG = 9
# Shift of the section's plane off the datum, as a share of the part, so that no edge lies in it.
ASIDE = 1e-5
# Distance of a cam's profile from its base circle from which the circle is drawn, mm on paper.
OFF = 0.5
# Most rows of a table in one frame, which fits on A4, and the distance of its lines from its words, mm on paper.
ROWS, INSET = 30, 1.5


def section_view(canvas: DrawingCanvas, exact: Cut, datum: complex, scale: float, pitch: float) -> None:
    """The half section through the datum, seen from the left at the right of the front view, with the thickness.

    Above the axis the part is cut, and below it is whole. `pitch` is the pitch radius of a gear, mm, 0 of other parts:
    its teeth are not hatched, and the lower half shows the direction of helical ones.
    """
    low, high = exact.box
    toothed = _toothed(exact) if pitch else None
    x = datum.real + ASIDE * (high - low).real
    cuts = [_crossings(loop.points, x) - datum.imag for loop in exact.loops if loop is not toothed]
    radii = np.abs(toothed.points - datum) if toothed else np.zeros(1)
    tip, root = float(radii.max()), float(radii.min())
    if toothed is not exact.loops[0]:
        tip, root = root, tip
    walls = np.sort(np.concatenate([*cuts, [tip] if toothed else []]))
    walls = walls[walls > 0]
    left, thick = canvas.box[1].real + 2 * AWAY, exact.part.thickness * scale
    at, right = complex(left, datum.imag * scale), complex(left + thick, datum.imag * scale)
    ends = left + 1j * low.imag * scale, left + thick + 1j * high.imag * scale
    canvas.add(PART, Polyline(np.array([ends[0], ends[0] + thick, ends[1], ends[1] - thick])))
    for wall in (*walls.tolist(), *([root] if toothed else [])):
        if abs(wall * scale - (ends[1] - at).imag) > OVER / 10:
            canvas.line(at + 1j * wall * scale, right + 1j * wall * scale, layer=PART)
    # An odd number of walls: material about the axis.
    bounds = [0.0, *walls.tolist()] if len(walls) % 2 else walls.tolist()
    solid = [root if toothed and bound == tip else bound for bound in bounds]
    for inner, outer in zip(solid[::2], solid[1::2]):
        _hatch(canvas, at + 1j * inner * scale, thick, (outer - inner) * scale)
    for radius in (0.0, pitch, -pitch) if pitch else (0.0,):
        canvas.line(at - OVER + 1j * radius * scale, right + OVER + 1j * radius * scale, layer=CENTRE)
    if pitch and exact.part.twist is not None and exact.part.twist.turn:
        for line in _tooth_lines(exact, pitch * scale, thick):
            canvas.line(*(at + line), layer=DIM)
    canvas.linear(complex(left, ends[1].imag), ends[1], 1j * AWAY, exact.part.thickness)


def _toothed(exact: Cut) -> Loop:
    """The contour with the teeth: the outline, or the widest opening of a ring."""
    if not isinstance(exact.loops[0].shape, Circle):
        return exact.loops[0]
    return max(exact.loops[1:], key=lambda loop: float(np.ptp(loop.points.real)))


def _crossings(points: Complex, x: float) -> Real:
    """Ordinates at which a closed contour crosses a vertical line."""
    following = np.roll(points, -1)
    crossed = (points.real > x) != (following.real > x)
    start, step = points[crossed], (following - points)[crossed]
    return np.asarray(start.imag + (x - start.real) / step.real * step.imag, dtype=float)


def _hatch(canvas: DrawingCanvas, corner: complex, width: float, height: float) -> None:
    """Lines at 45 degrees in a rectangle, by its lower left corner."""
    for start in np.arange(HATCHED - height, width, HATCHED).tolist():
        low, high = max(0.0, start), min(width, start + height)
        canvas.line(corner + complex(low, low - start), corner + complex(high, high - start))


def _tooth_lines(exact: Cut, pitch: float, thick: float) -> Iterator[Complex]:
    """The three lines that show the direction of helical teeth on the lower half, from the left end of the axis."""
    twist, share = exact.part.twist, np.linspace(0, 1, ALONG)
    assert twist is not None
    # Seen from the left, what turns counterclockwise about the axis moves downwards.
    down = pitch * np.angle(np.asarray(twist.at(share).direction))
    for k in (-1, 0, 1):
        line = thick * share - 1j * (down - down.mean() + pitch / 2 + k * TEETH_APART)
        yield line[np.abs(line.imag + pitch / 2) < pitch / 2]


def base_circle(
    canvas: DrawingCanvas, profile: Loop, datum: complex, radius: float, scale: float
) -> dict[str, list[tuple[complex, float, complex]]]:
    """Draw a cam's base circle where the profile is off it, and return the arc with its words, for a leader."""
    spokes = profile.points - datum
    order = np.argsort(np.angle(spokes))
    around = np.radians(np.arange(-180, 181, 2.0))
    heights = np.interp(around, np.angle(spokes)[order], np.abs(spokes)[order], period=2 * np.pi)
    is_off = (heights - radius) * scale > OFF
    runs = np.split(np.flatnonzero(is_off), np.flatnonzero(np.diff(np.flatnonzero(is_off)) > 1) + 1)
    for run in runs:
        if len(run) > 1:
            canvas.line(*(datum + radius * np.exp(1j * around[run])) * scale, layer=CENTRE)
    longest = max(runs, key=len)
    if len(longest) < 2:
        return {}
    middle = complex(np.exp(1j * around[longest[len(longest) // 2]]))
    return {f"base R{length_text(radius, canvas.unit)}": [(datum, radius, middle)]}


def draw_table(unit: LengthUnit, name: str, rows: Sequence[Sequence[str]]) -> Iterator[DrawingCanvas]:
    """The rows of a table below its heading and the name of its part, in frames of equally many rows."""
    heading = rows[0]
    ends = np.linspace(1, len(rows), 1 - (1 - len(rows)) // ROWS).astype(int).tolist()
    for start, end in pairwise(ends):
        canvas, block = DrawingCanvas(unit), [heading, *rows[start:end]]
        bottom = -len(block) * LINE
        widths = [max(width_of(row[k], LETTER) for row in block) + 2 * INSET for k in range(len(heading))]
        lefts = np.cumsum([0.0, *widths])
        canvas.words(name, complex(0, LINE / 2))
        for number, row in enumerate(block):
            for words, x in zip(row, lefts.tolist()):
                canvas.words(words, complex(x + INSET, -(number + 0.5) * LINE))
        for x in lefts.tolist():
            canvas.line(complex(x, 0), complex(x, bottom))
        for y in (0, -LINE, bottom):
            canvas.line(complex(0, y), complex(lefts[-1], y))
        yield canvas


def point_table(
    canvas: DrawingCanvas, datum: complex, scale: float, located: Sequence[tuple[complex, float]]
) -> list[Sequence[str]]:
    """Coordinates of numbered points, whose numbers are written at them."""
    places = list({(round(p.real, 6), round(p.imag, 6)): p for p, _ in located}.values())
    rows: list[Sequence[str]] = [("point", "x", "y")]
    offsets = without_noise(np.array(places) - datum).tolist()
    for number, (place, offset) in enumerate(zip(places, offsets), 1):
        words = str(number) if canvas.label(str(number), place * scale) else f"{number} (not marked)"
        rows.append((words, *(length_text(value, canvas.unit) for value in (offset.real, offset.imag))))
    return rows
