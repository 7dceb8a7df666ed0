"""Points along the path of an SVG drawing."""

from __future__ import annotations

import re
from typing import Annotated

import numpy as np

from ...core.arguments import checked, whole_between
from ...core.errors import DesignError, printable
from ...core.fields import FARTHEST
from ...plane.vec import Complex

# Characters of a path at most: more are another thing by mistake.
LONGEST = 1_000_000
# Commands of a run at most: more are a traced picture, and take seconds.
MOST_COMMANDS = 5_000
# Places on each curve of a path that its length is taken from: fewer set points unevenly.
SHARES = np.arange(1, 65) / 64
# Numbers that each command takes at a time.
TAKES = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7, "z": 0}
NUMBER = re.compile(r"[\s,]*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
FLAG = re.compile(r"[\s,]*([01])")
COMMAND = re.compile(r"[\s,]*([a-zA-Z])")


@checked
def svg_path_points(path: str, count: Annotated[int, whole_between(3, 1000)] = 60) -> tuple[Complex, bool]:
    """So many points (count,), mm, at equal lengths along a path's first run, and whether it closes.

    path: the text of the attribute `d` of an SVG path; one unit is 1 mm, and y goes up where it goes down in SVG. Of an
    open one both ends are among the points, of a closed one its start once. Further runs are left out. DesignError for
    what is no such text. The grammar: Scalable Vector Graphics 1.1, 8.3, its arcs by F.6.5.
    """
    return evenly_spaced(*first_run(path), count)


def evenly_spaced(line: Complex, closed: bool, count: int) -> tuple[Complex, bool]:
    """So many points at equal lengths along a line of many points, mirrored so that y goes up; and `closed`."""
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])
    if not 0 < length[-1] < FARTHEST:
        raise DesignError("path", f"is {length[-1]:g} mm long", "give a path with a length")
    kept = np.append(True, np.diff(length) > 0)
    at = np.linspace(0, length[-1], count, endpoint=not closed)
    return np.conj(np.interp(at, length[kept], line[kept])), closed


class _Reader:
    """The text of a path, read from its start."""

    def __init__(self, text: str):
        self.text, self.at = text, 0

    def take(self, pattern: re.Pattern[str]) -> str | None:
        """What comes next, if it is of the pattern."""
        found = pattern.match(self.text, self.at)
        if found is None:
            return None
        self.at = found.end()
        return found.group(1)

    def numbers(self, command: str) -> list[float]:
        """The numbers of one command."""
        told = []
        for k in range(TAKES[command]):
            # The two flags of an arc may stand without a gap.
            number = self.take(FLAG if command == "a" and k in (3, 4) else NUMBER)
            if number is None:
                found = printable(repr(self.text[self.at : self.at + 20]))
                raise DesignError("path", f"at character {self.at} holds {found}", f"give {TAKES[command]} numbers")
            told.append(float(number))
            if abs(told[-1]) > FARTHEST:
                raise DesignError("path", f"holds {printable(number, 30)}", f"give numbers within {FARTHEST:g} of 0")
        return told


def first_run(path: str) -> tuple[Complex, bool]:
    """The first run of a path's text as a line of many points, in SVG's own coordinates, and whether it closes."""
    if len(path) > LONGEST:
        raise DesignError("path", f"has {len(path):,} characters", f"give at most {LONGEST:,}", "too-much-work")
    reader, line, commands = _Reader(path), [], 0
    first = reader.take(COMMAND)
    if first is None or first.lower() != "m":
        raise DesignError(
            "path", f"found {printable(repr(path[:20]))}", "give the text of a path, as M 0 0 L 10 5 C ..."
        )
    here = start = complex(*reader.numbers("m"))
    command, handle, before = ("L" if first == "M" else "l"), here, ""
    line.append(here)
    while True:
        told = reader.take(COMMAND)
        if told is None and not reader.text[reader.at :].strip(" ,\t\r\n"):
            break
        command = told or command
        kind = command.lower()
        if kind not in TAKES:
            found = printable(repr(reader.text[reader.at - 1 : reader.at + 10]))
            raise DesignError("path", f"at character {reader.at} holds {found}", "give the commands of SVG paths")
        if kind == "z":
            return _within_reach([*line, start]), True
        if kind == "m":
            break
        commands += 1
        if commands > MOST_COMMANDS:
            raise DesignError("path", f"has more than {MOST_COMMANDS:,} commands", "simplify it")
        piece, handle = _piece(kind, reader.numbers(kind), here, 0 if command.isupper() else here, handle, before)
        line.extend(piece)
        here, before = line[-1], kind
    points = _within_reach(line)
    size = float(np.abs(points - points[0]).max())
    return points, bool(len(points) > 3 and abs(points[-1] - points[0]) <= 1e-6 * size)


def _within_reach(line: list[complex]) -> Complex:
    points = np.array(line)
    if not (np.abs(points) < FARTHEST).all():
        raise DesignError("path", "has points too far away", f"give places within {FARTHEST:g} of 0")
    return points


def _piece(
    kind: str, told: list[float], here: complex, base: complex, handle: complex, before: str
) -> tuple[list[complex], complex]:
    """The points of one command after its start, and the handle that a smooth one after it takes up."""
    t = SHARES
    if kind in "hv":
        across = complex(told[0] + base.real, here.imag) if kind == "h" else complex(here.real, told[0] + base.imag)
        return [across], across
    if kind == "a":
        end = complex(told[5], told[6]) + base
        return _arc(here, end, told), end
    places = [complex(x, y) + base for x, y in zip(told[::2], told[1::2])]
    if kind == "l":
        return places, places[0]
    if kind in "st":
        same = before in ("cs" if kind == "s" else "qt") and before != ""
        places = [2 * here - handle if same else here, *places]
    if len(places) == 3:
        one, two, end = places
        curve = (1 - t) ** 3 * here + 3 * t * (1 - t) ** 2 * one + 3 * t**2 * (1 - t) * two + t**3 * end
        return curve.tolist(), two
    one, end = places
    return ((1 - t) ** 2 * here + 2 * t * (1 - t) * one + t**2 * end).tolist(), one


def _arc(start: complex, end: complex, told: list[float]) -> list[complex]:
    """An elliptic arc from its ends: seen from the middle of its chord, so that huge radii lose no digits."""
    wide, high, turn = abs(told[0]), abs(told[1]), complex(np.exp(1j * np.radians(told[2])))
    radius = max(wide, high)
    if wide == 0 or high == 0 or start == end:
        return [end]
    # In the frame in which the ellipse is a circle of this radius; too small a one is enlarged.
    wide, high, chord = wide / radius, high / radius, (end - start) / 2 / turn
    if wide * high == 0:
        return [complex(np.inf)]
    chord = complex(chord.real / wide, chord.imag / high)
    radius = max(radius, abs(chord))
    if not 0 < abs(chord) < np.inf:
        return [end if chord == 0 else complex(np.inf)]
    half_turn = float(np.arcsin(min(1.0, abs(chord) / radius)))
    if told[3]:
        half_turn = np.pi - half_turn
    along = radius * np.sin(half_turn * (2 * SHARES - 1))
    aside = 2 * radius * np.sin(half_turn * SHARES) * np.sin(half_turn * (1 - SHARES))
    on = chord / abs(chord) * (along + (-1j if told[4] else 1j) * aside)
    points: list[complex] = ((start + end) / 2 + turn * (wide * on.real + 1j * high * on.imag)).tolist()
    return [*points[:-1], end]
