"""Dwell of an output: the longest range of the driver over which it stays within a band."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Real, dot
from .motion import Motion, is_translating

# Largest number of points between two frames at which the output is evaluated first, and in all. With fewer, a dwell
# that ends at a steep point is reported too short.
BETWEEN, LOOKS = 16, 20_000
# Relative difference of two dwells that are equal.
EQUAL = 1e-9
# Difference of a turn's end from its start, of unit directions and in sizes, up to which it is periodic.
CLOSED = 1e-9


@record
class OutputDwell:
    """The longest dwell of a body.

    Parameters
    ----------
    start, end : float
        Drives, rad or mm. For a driver that turns continuously `end` may be beyond the last frame: the dwell goes on in
        the next turn.
    low, high : float
        Least and greatest output during the dwell: rad, or mm for a body that slides.
    """

    start: float
    end: float
    low: float
    high: float

    @property
    def range(self) -> float:
        """Range of the driver over which the output dwells, rad or mm."""
        return self.end - self.start


@checked
def longest_dwell(motion: Motion, output: str, band: PositiveFloat) -> OutputDwell:
    """The longest range of the driver over which a body's angle, or displacement if it slides, stays within a band.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage, its drives rising or falling. Between frames the output is a cubic with its values and
        slopes there.
    output : str
        Name of the body.
    band : float
        Greatest less least value during the dwell: rad for a body that turns, mm for one that slides on the ground;
        above 0.

    Returns
    -------
    OutputDwell

    Raises
    ------
    DesignError
        If the linkage has no such body, the body neither turns nor slides on the ground, or no two neighbouring frames
        are reached.

    Notes
    -----
    Derived here: of all points between the frames, the two farthest apart between which the output stays
    within the band.
    """
    drive, value, slope = motion.drive, *_output(motion, output)
    if len(drive) and drive[-1] < drive[0]:
        # The same positions, in the order of rising drives.
        drive, value, slope = drive[::-1], value[::-1], slope[::-1]
    last, turn = drive[-1] if len(drive) else np.nan, float(np.ptp(drive)) if len(drive) else np.nan
    if motion.linkage.driven_slider is None and _is_periodic(motion):
        # A dwell may begin in one turn and end in the next.
        drive = np.append(drive, drive[1:] + (drive[-1] - drive[0]))
        value, slope = np.append(value, value[1:] + (value[-1] - value[0])), np.append(slope, slope[1:])
    t, y = _between(drive, value, slope, BETWEEN)
    if not np.isfinite(np.diff(y)).any():
        problem = "found no two neighbouring frames that are reached"
        raise DesignError("motion", problem, "give drives that it reaches", "does-not-assemble")
    start, end = _longest(t, y, float(band))
    # Once more between the frames around it, at more points.
    near = slice(max(int(np.searchsorted(drive, t[start])) - 2, 0), int(np.searchsorted(drive, t[end])) + 2)
    t, y = _between(drive[near], value[near], slope[near], LOOKS)
    start, end = _longest(t, y, float(band))
    # Extended to the points at which it leaves the band, at the end and then at the start.
    inside = y[start : end + 1]
    t_end, y_end = _leaves_band_at(t, y, end, end + 1, inside.min(), inside.max(), float(band))
    inside = np.append(inside, y_end)
    t_start, y_start = _leaves_band_at(t, y, start, start - 1, inside.min(), inside.max(), float(band))
    inside = np.append(inside, y_start)
    first = t_start - turn if t_start >= last else t_start
    return OutputDwell(first, first + min(t_end - t_start, turn), float(inside.min()), float(inside.max()))


def _output(motion: Motion, output: str) -> tuple[Real, Real]:
    """Angle, rad, or displacement along its slide, mm, and its derivative by the drive."""
    general = motion.linkage
    if general.is_batch:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time", "wrong-type")
    if output not in general.bodies or output == general.ground:
        raise DesignError(
            "output", f"found {output!r}", f"give one of {', '.join(list(general.bodies)[1:])}", "unknown-key"
        )
    body = motion.bodies[output]
    if not is_translating(motion, output):
        angle = np.angle(body.direction)
        angle[motion.assembled] = np.unwrap(angle[motion.assembled])
        return angle, body.first
    slider = next((s for s in general.sliders if {s.body, s.along} == {output, general.ground}), None)
    if slider is None:
        problem = f"found {output}, which translates and is not guided along a line of the {general.ground}"
        raise DesignError("output", problem, "give a body that turns or slides on the ground", "conflict")
    line = motion.bodies[slider.along].direction * slider.direction * (1 if slider.body == output else -1)
    return dot(line, body.origin.position), dot(line, body.origin.first)


def _is_periodic(motion: Motion) -> bool:
    """Whether the frames are one turn of the driver, after which the linkage is in its first pose."""
    if abs(abs(motion.drive[-1] - motion.drive[0]) - 2 * np.pi) > CLOSED or not motion.assembled.all():
        return False
    size = float(motion.linkage.size) or 1.0
    return all(
        abs(b.direction[-1] - b.direction[0]) + abs(b.origin.position[-1] - b.origin.position[0]) / size < CLOSED
        for b in motion.bodies.values()
    )


def _between(drive: Real, value: Real, slope: Real, most: int) -> tuple[Real, Real]:
    """Drives and values at the frames and `most` points between them, by cubics; nan without a value or slope."""
    parts = int(np.clip(LOOKS // max(1, len(drive)), 1, most))
    s, step = np.arange(parts) / parts, np.diff(drive)[:, None]
    from_one = (1 + 2 * s) * (1 - s) ** 2 * value[:-1, None] + s * (1 - s) ** 2 * step * slope[:-1, None]
    from_two = s**2 * (3 - 2 * s) * value[1:, None] - s**2 * (1 - s) * step * slope[1:, None]
    return np.append(drive[:-1, None] + s * step, drive[-1]), np.append(from_one + from_two, value[-1])


def _longest(t: Real, y: Real, band: float) -> tuple[int, int]:
    """First and last of the points between which values stay within a band for longest."""
    best, longest = (0, 0), 0.0
    for start, end, least, greatest in _windows(y.tolist(), band):
        if t[end] - t[max(start - 1, 0)] > longest:
            first, _ = _leaves_band_at(t, y, start, start - 1, least, greatest, band)
            # Of two that are equal but for rounding the first, on every processor.
            if t[end] - first > (1 + EQUAL) * longest:
                best, longest = (start, end), float(t[end] - first)
    return best


def _windows(y: list[float], band: float) -> Iterator[tuple[int, int, float, float]]:
    """Each range of points, first and last, that leaves a band with its next point; least and greatest value in it."""
    start, low, high = 0, deque[int](), deque[int]()
    for end, value in enumerate([*y, np.nan]):
        if low and (value != value or max(y[high[0]], value) - min(y[low[0]], value) > band):
            yield start, end - 1, y[low[0]], y[high[0]]
        if value != value:
            start = end + 1
            low.clear()
            high.clear()
            continue
        while low and y[low[-1]] >= value:
            low.pop()
        while high and y[high[-1]] <= value:
            high.pop()
        low.append(end)
        high.append(end)
        while y[high[0]] - y[low[0]] > band:
            start += 1
            for queue in (low, high):
                if queue[0] < start:
                    queue.popleft()


def _leaves_band_at(
    t: Real, y: Real, inside: int, outside: int, least: float, greatest: float, band: float
) -> tuple[float, float]:
    """Point between two neighbouring points at which the value leaves the band."""
    if not 0 <= outside < len(t) or not np.isfinite(y[outside]):
        return float(t[inside]), float(y[inside])
    border = least + band if y[outside] > y[inside] else greatest - band
    share = float((border - y[inside]) / (y[outside] - y[inside])) if y[outside] != y[inside] else 0.0
    share = min(max(share, 0.0), 1.0)
    return float(t[inside] + share * (t[outside] - t[inside])), float(y[inside] + share * (y[outside] - y[inside]))
