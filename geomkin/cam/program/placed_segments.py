"""Start and end of the segments of a programme: angles and lifts, computed from the given ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import check_quantities
from ...core.names import Folder
from ...core.records import record
from ...core.units import mm
from ...plane.vec import Real
from .given_lifts import MOST_ROWS, checked_rows, read_lifts
from .segments import Dwell, LiftPolynomial, LiftTable, Pointed, Return, Rise, Segment, Timed

# Tolerance of sums of given angles, deg, and lifts, mm or deg. A smaller value refuses thirds of a turn written with
# nine digits, a larger one hides a real gap.
SLIP = 1e-7
# Largest number of segments of a programme. More take seconds, and are more than a cam can have.
MOST_SEGMENTS = 10_000


@record(eq=False)
class PlacedSegment:
    """A segment with its limits.

    Parameters
    ----------
    place : str
        Its name in messages, such as `program[2]`.
    segment : segment
        As the recipe has it.
    start, end : float
        Cam angles, deg.
    lift, end_lift : float
        Lift at start and end, mm, or deg if `oscillates`.
    oscillates : bool or None
        Whether lifts are angles of an arm; None if it suits both kinds of follower, as a dwell does.
    points : ndarray, shape (n, 2)
        Given angles, deg, and lifts of a spline or a table; intermediate ones of a polynomial.
    """

    place: str
    segment: Segment
    start: float
    end: float
    lift: float
    end_lift: float
    oscillates: bool | None
    points: Real

    @property
    def radians(self) -> float:
        return float(np.radians(self.end) - np.radians(self.start))

    def x(self, angle: Real) -> Real:
        """Share of the segment, 0 at the start and 1 at the end, for angles in deg."""
        return (angle - self.start) / (self.end - self.start)


@contextmanager
def errors_named_by_segment(place: str) -> Iterator[None]:
    """Put the segment's name before the field of a DesignError."""
    try:
        yield
    except DesignError as error:
        field = f"{place}.{error.field}" if error.field else place
        raise DesignError(field, error.problem, error.remedy, error.id) from None


def place_segments(segments: Sequence[Segment], folder: Folder) -> list[PlacedSegment]:
    """Limits of the segments from 0 to 360 deg. folder: of files of tables. Raises DesignError if they do not fit."""
    made: list[PlacedSegment] = []
    angle, lift, rows = 0.0, 0.0, 0
    if len(segments) > MOST_SEGMENTS:
        problem = f"found {len(segments):,} segments"
        raise DesignError("program", problem, f"give at most {MOST_SEGMENTS:,}", "too-much-work")
    for k, segment in enumerate(segments):
        place = f"program[{k}]"
        with errors_named_by_segment(place):
            if not isinstance(segment, Segment):
                raise DesignError("", f"found {shown(segment)}", "give a segment, such as Dwell or Rise", "wrong-type")
            check_quantities(segment)
            if isinstance(segment, Pointed):
                placed = _segment_of_points(
                    place, segment, angle, lift if k else None, folder, alone=len(segments) == 1
                )
            else:
                end = _end(segment, angle)
                end_lift, oscillates = _end_lift(segment, lift)
                placed = PlacedSegment(
                    place, segment, angle, end, lift, end_lift, oscillates, _between(segment, angle, end)
                )
        made.append(placed)
        angle, lift = placed.end, placed.end_lift
        rows += len(made[-1].points)
        if rows > MOST_ROWS:
            problem = f"with it, the programme has {rows:,} rows"
            raise DesignError(place, problem, f"give at most {MOST_ROWS:,} in all", "too-much-work")
    _check_whole(made, angle, lift)
    # A rounding error of the last lift would be a jump at the end of the turn.
    last = made[-1].points.copy()
    last[-1:, 1:] = made[0].lift if isinstance(made[-1].segment, Pointed) else last[-1:, 1:]
    return [*made[:-1], replace(made[-1], end_lift=made[0].lift, points=last)]


def _check_whole(made: list[PlacedSegment], angle: float, lift: float) -> None:
    if abs(angle - 360) > SLIP:
        problem = f"the segments end at {angle:g} deg"
        raise DesignError("program", problem, "make the last one end at 360 deg", "out-of-range")
    swings = {placed.oscillates: placed.place for placed in made if placed.oscillates is not None}
    if len(swings) == 2:
        problem = f"{swings[False]} has its lift in mm and {swings[True]} in degrees"
        remedy = "give all in mm for a translating follower, or all in degrees for an oscillating one"
        raise DesignError("program", problem, remedy, "conflict")
    unit = "deg" if True in swings else "mm"
    if abs(lift - made[0].lift) > max(SLIP, band(made[-1].segment)):
        problem = f"the lift ends at {mm(lift, unit=unit):g}, not at {mm(made[0].lift, unit=unit):g}"
        raise DesignError("program", problem, "add a return, or correct its end_lift", "conflict")


def _end(segment: Timed, before: float) -> float:
    start = before if segment.start_deg is None else segment.start_deg
    if abs(start - before) > SLIP:
        raise DesignError("start_deg", *_apart(start, before))
    ends = [segment.end_deg, None if segment.duration_deg is None else before + segment.duration_deg]
    known = [e for e in ends if e is not None]
    if not known or (len(known) == 2 and abs(known[0] - known[1]) > SLIP):
        found = "neither" if not known else "two that disagree"
        raise DesignError("end_deg", f"of end_deg and duration_deg found {found}", "give one of them", "conflict")
    if known[0] - before <= SLIP:
        problem = f"the segment runs from {before:g} to {known[0]:g} deg"
        raise DesignError("end_deg", problem, "give an end after its start", "out-of-range")
    # The last segment ends exactly at the end of the turn.
    return 360.0 if abs(known[0] - 360) <= SLIP else known[0]


def _apart(start: float, before: float) -> tuple[str, str]:
    if not before:
        return f"found {start:g} deg, but the programme starts at 0 deg", "start there, or omit start_deg"
    kind = "a gap" if start > before else "an overlap"
    return (
        f"found {start:g}, but the segment before ends at {before:g} deg: {kind}",
        "omit start_deg, or add a dwell between them",
    )


def _end_lift(segment: Timed, before: float) -> tuple[float, bool | None]:
    """Lift at the end, and whether it was given in degrees; None if unknown."""
    if isinstance(segment, Dwell):
        return before, None
    field, end, oscillates = _given_end(segment, before)
    unit = "deg" if oscillates else "mm"
    if isinstance(segment, Rise) and end <= before:
        problem = f"it ends at {mm(end, unit=unit):g}, not above its start"
        raise DesignError(field, problem, "use a return to go down", "out-of-range")
    if isinstance(segment, Return) and end >= before:
        problem = f"it ends at {mm(end, unit=unit):g}, not below its start"
        raise DesignError(field, problem, "use a rise to go up", "out-of-range")
    if end < 0:
        limits = {"fall": f"at most {mm(before, unit=unit):down}", "rise": f"at least {mm(-before, unit=unit):up}"}
        limit = limits.get(field.removesuffix("_deg"), f"at least {mm(0, unit=unit):g}")
        problem = f"it ends at {mm(end, unit=unit):g}, below the base circle"
        raise DesignError(field, problem, f"give {limit}", "out-of-range")
    return end, oscillates


def _given_end(segment: Timed, before: float) -> tuple[str, float, bool | None]:
    """The field that gives the end of a segment, the lift there, and whether it is in degrees; None if unknown."""
    change = "fall" if isinstance(segment, Return) else "rise"
    names = (change, "end_lift", f"{change}_deg", "end_lift_deg")
    # A return ends at 0 unless another end is given.
    given = [
        (name, value)
        for name in names
        if (value := getattr(segment, name)) is not None and (value or (change, name) != ("fall", "end_lift"))
    ]
    if change == "fall" and not given:
        return "end_lift", 0.0, None
    if len(given) != 1:
        found = "neither" if not given else "both" if len(given) == 2 else "more"
        problem, remedy = f"of {change} and end_lift found {found}", "give one of them, in mm or in degrees"
        raise DesignError(given[0][0] if given else change, problem, remedy, "conflict")
    ((name, value),) = given
    end = value if name.startswith("end") else before - value if change == "fall" else before + value
    # 0.3 - 0.1 - 0.2 is 0.
    return name, 0.0 if abs(end) < 1e-12 * abs(value) else end, name.endswith("_deg")


def _segment_of_points(
    place: str, segment: Pointed, before: float, lift: float | None, folder: Folder, alone: bool
) -> PlacedSegment:
    """A segment with its own points. lift: of the segment before, None for the first."""
    field, points, oscillates = read_lifts(segment, folder)
    # Rows of a file have no index in the recipe; messages name their angle.
    row = "" if field == "file" else "[{}]"
    unit = "deg" if oscillates else "mm"
    if len(points) < 2:
        raise DesignError(field, f"found {len(points)}", "give at least two rows, for start and end", "out-of-range")
    falls = np.flatnonzero(np.diff(points[:, 0]) <= 0)
    if len(falls):
        k = int(falls[0])
        problem = f"the angle {points[k + 1, 0]:g} deg follows {points[k, 0]:g} deg"
        raise DesignError(field + row.format(k + 1), problem, "give rising angles", "out-of-range")
    low = int(points[:, 1].argmin())
    # Measured rows of a dwell deviate to both sides.
    if points[low, 1] < -band(segment):
        problem = f"the lift is {mm(points[low, 1], unit=unit):g} at {points[low, 0]:g} deg, below the base circle"
        remedy = f"give {mm(0, unit=unit):g} or more, and a smaller base_radius"
        raise DesignError(field + row.format(low), problem, remedy, "out-of-range")
    if alone:
        points = _from_zero(points, segment, unit)
    start, end = points[[0, -1], 0]
    if abs(start - before) > SLIP:
        problem, _ = _apart(start, before)
        remedy = f"start the angles at {before:g} deg"
        if alone:
            remedy += ", or give a whole turn with a row at 0 deg"
        raise DesignError(field + row.format(0), problem, remedy, "out-of-range")
    start, end = before, 360.0 if abs(end - 360) <= SLIP else float(end)
    slip = band(segment) or SLIP
    if lift is None:
        lift = float(points[0, 1])
    if abs(points[0, 1] - lift) > slip:
        start, end = mm(points[0, 1], unit=unit), mm(lift, unit=unit)
        problem = f"the lift starts at {start:g}, but the segment before ends at {end:g}"
        raise DesignError(field + row.format(0), problem, "give equal lifts", "conflict")
    points[[0, -1], 0], points[0, 1] = (start, end), lift
    return PlacedSegment(place, segment, start, end, lift, float(points[-1, 1]), oscillates, points)


def _from_zero(points: Real, segment: Pointed, unit: str) -> Real:
    """Rows of a whole turn from 0 to 360 deg, of those that start elsewhere, as those of cam cards from -180 deg do.

    The last row of a table in equal steps may be missing: the next one would be the first one again.
    """
    first, end = points[0], points[0, 0] + 360
    steps = np.diff([*points[:, 0], end])
    if isinstance(segment, LiftTable) and np.ptp(steps) <= 1e-6 * steps[0]:
        points = np.vstack([points, [end, first[1]]])
    zero = np.flatnonzero(np.abs(points[:, 0] % 360 - [[0.0], [360.0]]).min(axis=0) <= SLIP)
    if abs(points[-1, 0] - end) > SLIP or not len(zero) or abs(first[0]) <= SLIP:
        return points
    if abs(points[-1, 1] - first[1]) > max(SLIP, band(segment)):
        problem = f"a whole turn starts at {mm(first[1], unit=unit):g} and ends at {mm(points[-1, 1], unit=unit):g}"
        raise DesignError("", problem, "give equal lifts in the first and the last row", "conflict")
    turned = np.vstack([points[zero[0] : -1], points[: zero[0] + 1] + np.array([360.0, 0.0])])
    turned[:, 0] -= turned[0, 0]
    return turned


def band(segment: Segment) -> float:
    """Band of a table's curve: as given, or 3/4 of the last decimal; 0 for a curve through the rows.

    Half of the last decimal is the rounding error itself; in a narrower band the curve follows the rounding.
    """
    if not isinstance(segment, LiftTable):
        return 0.0
    if segment.within is not None:
        return segment.within
    if segment.decimals is None:
        raise DesignError("decimals", "of decimals and within found neither", "give one of them", "missing-key")
    return 0.75 * 10.0**-segment.decimals if segment.decimals < 10 else 0.0


def _between(segment: Timed, start: float, end: float) -> Real:
    if not isinstance(segment, LiftPolynomial):
        return np.zeros((0, 2))
    if isinstance(segment.through, (tuple, list)) and not segment.through:
        return np.zeros((0, 2))
    points = checked_rows(segment.through, "through")
    outside = np.flatnonzero((points[:, 0] <= start) | (points[:, 0] >= end))
    if len(outside):
        k = int(outside[0])
        problem = f"found {points[k, 0]:g} deg"
        raise DesignError(f"through[{k}]", problem, f"give an angle between {start:g} and {end:g} deg", "out-of-range")
    return points
