"""Points along the path of an SVG drawing."""

from __future__ import annotations

import re
from typing import Annotated

import numpy as np

from ...core.arguments import checked, whole_between
from ...core.errors import DesignError, printable
from ...core.fields import FARTHEST
from ...plane.vec import Complex

# Largest number of characters of a path; longer texts are not paths.
MOST_CHARACTERS = 1_000_000
# Largest number of commands of a subpath; longer ones are traced pictures and take seconds.
MOST_COMMANDS = 5_000
# Parameters on each curve from which its length is measured; fewer space the points unevenly.
PARAMETERS = np.arange(1, 65) / 64
# Number of arguments of each command.
ARGUMENT_COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7, "z": 0}
PATH_NUMBER = re.compile(r"[\s,]*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
FLAG = re.compile(r"[\s,]*([01])")
COMMAND = re.compile(r"[\s,]*([a-zA-Z])")


@checked
def svg_path_points(path: str, count: Annotated[int, whole_between(3, 1000)] = 60) -> tuple[Complex, bool]:
    """Sample points at equal arc lengths along the first subpath of an SVG path.

    Parameters
    ----------
    path : str
        The attribute `d` of an SVG path. One unit is 1 mm.
    count : int
        Number of points, 3 to 1000.

    Returns
    -------
    points : array of complex, shape (count,)
        The points, mm, with y up (SVG has y down). An open path includes both ends, a closed one its start once.
    closed : bool
        Whether the subpath is closed.

    Raises
    ------
    DesignError
        If the text is not a path, or the subpath has no length.

    Notes
    -----
    Further subpaths are ignored. Grammar: Scalable Vector Graphics 1.1, 8.3; arcs: appendix F.6.5.

    Examples
    --------
    >>> from geomkin.synthesis import svg_path_points
    >>> points, closed = svg_path_points("M 0 0 L 10 0", 3)
    >>> points.real.tolist(), closed
    ([0.0, 5.0, 10.0], False)
    """
    return evenly_spaced(*first_subpath(path), count)


def evenly_spaced(line: Complex, closed: bool, count: int) -> tuple[Complex, bool]:
    """Points at equal lengths along a polyline, mirrored so that y goes up; and `closed`."""
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])
    if not 0 < length[-1] < FARTHEST:
        raise DesignError("path", f"is {length[-1]:g} mm long", "give a path with a length", "out-of-range")
    is_distinct = np.append(True, np.diff(length) > 0)
    positions = np.linspace(0, length[-1], count, endpoint=not closed)
    return np.conj(np.interp(positions, length[is_distinct], line[is_distinct])), closed


class _Reader:
    """The text of a path, read from its start."""

    def __init__(self, text: str):
        self.text, self.at = text, 0

    def take(self, pattern: re.Pattern[str]) -> str | None:
        """The next token, if it matches the pattern."""
        found = pattern.match(self.text, self.at)
        if found is None:
            return None
        self.at = found.end()
        return found.group(1)

    def numbers(self, command: str) -> list[float]:
        values = []
        for k in range(ARGUMENT_COUNTS[command]):
            # The two flags of an arc need no separator.
            number = self.take(FLAG if command == "a" and k in (3, 4) else PATH_NUMBER)
            if number is None:
                found = printable(repr(self.text[self.at : self.at + 20]))
                raise DesignError(
                    "path",
                    f"at character {self.at} holds {found}",
                    f"give {ARGUMENT_COUNTS[command]} numbers",
                    "wrong-type",
                )
            values.append(float(number))
            if abs(values[-1]) > FARTHEST:
                raise DesignError(
                    "path", f"holds {printable(number, 30)}", f"give numbers within {FARTHEST:g} of 0", "out-of-range"
                )
        return values


def first_subpath(path: str) -> tuple[Complex, bool]:
    """The first subpath as a polyline in SVG coordinates, and whether it is closed."""
    if len(path) > MOST_CHARACTERS:
        raise DesignError("path", f"has {len(path):,} characters", f"give at most {MOST_CHARACTERS:,}", "too-much-work")
    reader, points, commands = _Reader(path), [], 0
    first = reader.take(COMMAND)
    if first is None or first.lower() != "m":
        raise DesignError(
            "path",
            f"found {printable(repr(path[:20]))}",
            "give the text of a path, as M 0 0 L 10 5 C ...",
            "wrong-type",
        )
    here = start = complex(*reader.numbers("m"))
    command, handle, previous = ("L" if first == "M" else "l"), here, ""
    points.append(here)
    while True:
        letter = reader.take(COMMAND)
        if letter is None and not reader.text[reader.at :].strip(" ,\t\r\n"):
            break
        command = letter or command
        kind = command.lower()
        if kind not in ARGUMENT_COUNTS:
            found = printable(repr(reader.text[reader.at - 1 : reader.at + 10]))
            raise DesignError(
                "path", f"at character {reader.at} holds {found}", "give the commands of SVG paths", "wrong-type"
            )
        if kind == "z":
            return _within_range([*points, start]), True
        if kind == "m":
            break
        commands += 1
        if commands > MOST_COMMANDS:
            raise DesignError("path", f"has more than {MOST_COMMANDS:,} commands", "simplify it", "too-much-work")
        piece, handle = _piece(kind, reader.numbers(kind), here, 0 if command.isupper() else here, handle, previous)
        points.extend(piece)
        here, previous = points[-1], kind
    polyline = _within_range(points)
    size = float(np.abs(polyline - polyline[0]).max())
    return polyline, bool(len(polyline) > 3 and abs(polyline[-1] - polyline[0]) <= 1e-6 * size)


def _within_range(line: list[complex]) -> Complex:
    points = np.array(line)
    if not (np.abs(points) < FARTHEST).all():
        raise DesignError("path", "has points too far away", f"give places within {FARTHEST:g} of 0", "out-of-range")
    return points


def _piece(
    kind: str, values: list[float], here: complex, base: complex, handle: complex, previous: str
) -> tuple[list[complex], complex]:
    """Points of one command after its start, and the control point that a following smooth command reflects."""
    t = PARAMETERS
    if kind in "hv":
        across = complex(values[0] + base.real, here.imag) if kind == "h" else complex(here.real, values[0] + base.imag)
        return [across], across
    if kind == "a":
        end = complex(values[5], values[6]) + base
        return _arc(here, end, values), end
    controls = [complex(x, y) + base for x, y in zip(values[::2], values[1::2])]
    if kind == "l":
        return controls, controls[0]
    if kind in "st":
        same = previous in ("cs" if kind == "s" else "qt") and previous != ""
        controls = [2 * here - handle if same else here, *controls]
    if len(controls) == 3:
        control_1, control_2, end = controls
        curve = (1 - t) ** 3 * here + 3 * t * (1 - t) ** 2 * control_1 + 3 * t**2 * (1 - t) * control_2 + t**3 * end
        return curve.tolist(), control_2
    control_1, end = controls
    return ((1 - t) ** 2 * here + 2 * t * (1 - t) * control_1 + t**2 * end).tolist(), control_1


def _arc(start: complex, end: complex, values: list[float]) -> list[complex]:
    """Elliptic arc between its ends, computed from the middle of its chord so that huge radii lose no digits."""
    wide, high, turn = abs(values[0]), abs(values[1]), complex(np.exp(1j * np.radians(values[2])))
    radius = max(wide, high)
    if wide == 0 or high == 0 or start == end:
        return [end]
    # In the frame in which the ellipse is a circle of this radius; a radius that is too small is enlarged.
    wide, high, chord = wide / radius, high / radius, (end - start) / 2 / turn
    if wide * high == 0:
        return [complex(np.inf)]
    chord = complex(chord.real / wide, chord.imag / high)
    radius = max(radius, abs(chord))
    if not 0 < abs(chord) < np.inf:
        return [end if chord == 0 else complex(np.inf)]
    half_turn = float(np.arcsin(min(1.0, abs(chord) / radius)))
    if values[3]:
        half_turn = np.pi - half_turn
    along = radius * np.sin(half_turn * (2 * PARAMETERS - 1))
    aside = 2 * radius * np.sin(half_turn * PARAMETERS) * np.sin(half_turn * (1 - PARAMETERS))
    on = chord / abs(chord) * (along + (-1j if values[4] else 1j) * aside)
    points: list[complex] = ((start + end) / 2 + turn * (wide * on.real + 1j * high * on.imag)).tolist()
    return [*points[:-1], end]
