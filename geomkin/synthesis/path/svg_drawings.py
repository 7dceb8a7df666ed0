"""The first path of an SVG drawing, in mm, with groups, transforms, uses, units and the view box, and points along it.

The standard library reads the XML. Unsupported elements and attributes that move a path are refused by name. After
Scalable Vector Graphics 2, chapters 5, 7 and 8.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from math import inf
from typing import Annotated, NamedTuple
from xml.etree import ElementTree

import numpy as np

from ...core.arguments import checked, whole_between
from ...core.errors import DesignError, printable, shown, with_article
from ...core.fields import FARTHEST
from ...core.units import marked, mm
from ...plane.vec import Complex

# Largest number of characters of a path; longer texts are not paths.
MOST_CHARACTERS = 1_000_000
# Largest number of commands of a subpath; longer ones are traced pictures and take seconds.
MOST_COMMANDS = 5_000
# Parameters on each curve from which its length is measured; fewer space the points unevenly.
PARAMETERS = np.arange(1, 65) / 64
# Parameters on each curve, and largest number of chords of an arc, of a drawing that is measured.
FINE_PARAMETERS, MOST_CHORDS = np.arange(1, 257) / 256, 100_000
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
        raise DesignError("path", f"is {mm(length[-1]):g} long", "give a path with a length", "out-of-range")
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
    return next(subpaths(path))


def subpaths(path: str, error: float = inf, most: int = MOST_COMMANDS) -> Iterator[tuple[Complex, bool]]:
    """The subpaths as polylines in SVG coordinates, and whether each is closed.

    The chords of an arc are within `error` of it, or a fixed number; most: number of commands of a subpath.
    """
    if len(path) > (longest := most * (MOST_CHARACTERS // MOST_COMMANDS)):
        raise DesignError("path", f"has {len(path):,} characters", f"give at most {longest:,}", "too-much-work")
    reader, commands = _Reader(path), 0
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
    points = [start]
    while True:
        letter = reader.take(COMMAND)
        if letter is None and not reader.text[reader.at :].strip(" ,\t\r\n"):
            break
        command = letter or command
        kind = command.lower()
        if kind not in ARGUMENT_COUNTS or (letter is None and kind == "z"):
            found = printable(repr(reader.text[max(reader.at - 1, 0) : reader.at + 10]))
            raise DesignError(
                "path", f"at character {reader.at} holds {found}", "give the commands of SVG paths", "wrong-type"
            )
        if kind == "z":
            yield _within_range([*points, start]), True
        elif kind == "m" and previous != "z":
            yield _open(points)
        if kind in "zm":
            here = start = start if kind == "z" else complex(*reader.numbers("m")) + (0 if command == "M" else here)
            command = {"M": "L", "m": "l"}.get(command, command)
            points, handle, previous, commands = [start], here, kind, 0
            continue
        commands += 1
        if commands > most:
            raise DesignError("path", f"has more than {most:,} commands", "simplify it", "too-much-work")
        base = 0 if command.isupper() else here
        piece, handle = _piece(kind, reader.numbers(kind), here, base, handle, previous, error)
        points.extend(piece)
        here, previous = points[-1], kind
    if previous != "z":
        yield _open(points)


def _open(points: list[complex]) -> tuple[Complex, bool]:
    polyline = _within_range(points)
    size = float(np.abs(polyline - polyline[0]).max())
    return polyline, bool(len(polyline) > 3 and abs(polyline[-1] - polyline[0]) <= 1e-6 * size)


def _within_range(line: list[complex]) -> Complex:
    points = np.array(line)
    if not (np.abs(points) < FARTHEST).all():
        raise DesignError("path", "has points too far away", f"give places within {FARTHEST:g} of 0", "out-of-range")
    return points


def _piece(
    kind: str, values: list[float], here: complex, base: complex, handle: complex, previous: str, error: float
) -> tuple[list[complex], complex]:
    """Points of one command after its start, and the control point that a following smooth command reflects."""
    t = PARAMETERS if error == inf else FINE_PARAMETERS
    if kind in "hv":
        across = complex(values[0] + base.real, here.imag) if kind == "h" else complex(here.real, values[0] + base.imag)
        return [across], across
    if kind == "a":
        end = complex(values[5], values[6]) + base
        return _arc(here, end, values, error), end
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


def _arc(start: complex, end: complex, values: list[float], error: float) -> list[complex]:
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
    t = PARAMETERS
    if error < radius:
        count = int(np.ceil(half_turn / np.arccos(1 - error / radius)))
        if count > MOST_CHORDS:
            raise DesignError("path", f"has an arc of {count:,} chords", "give a smaller arc", "too-much-work")
        t = np.arange(1, count + 1) / count
    along = radius * np.sin(half_turn * (2 * t - 1))
    aside = 2 * radius * np.sin(half_turn * t) * np.sin(half_turn * (1 - t))
    on = chord / abs(chord) * (along + (-1j if values[4] else 1j) * aside)
    points: list[complex] = ((start + end) / 2 + turn * (wide * on.real + 1j * high * on.imag)).tolist()
    return [*points[:-1], end]


# Largest number of elements and of visits to them, which nested uses multiply; processed in a second.
MOST_ELEMENTS = 50_000
MOST_VISITS = 10_000
# Largest depth of nested elements, uses included.
DEEPEST = 100
LONGEST_ATTRIBUTE = 10_000
SVG = "{http://www.w3.org/2000/svg}"
HREF = "{http://www.w3.org/1999/xlink}href"
DRAWN = ("g", "a", "svg", "symbol", "use", "path")
SHAPES = ("rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "image")
# CSS pixels, user units, of each unit of length.
PIXELS = {"": 1, "px": 1, "in": 96, "cm": 96 / 2.54, "mm": 96 / 25.4, "q": 96 / 101.6, "pt": 96 / 72, "pc": 16}
MM_PER_PIXEL = 25.4 / 96
# Allowed counts of numbers of each transform.
TRANSFORMS = {"matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewX": (1,), "skewY": (1,)}

NUMBER = r"[+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][+-]?[0-9]++)?+"
NUMBERS = re.compile(rf"[\s,]*+(?:{NUMBER}[\s,]*+)*+")
LENGTH = re.compile(rf"\s*+({NUMBER})\s*+([a-zA-Z%]*+)\s*+")
TRANSFORM = re.compile(r"[\s,]*+([a-zA-Z]++)\s*+\(([^()]*+)\)[\s,]*+")
ALIGNMENT = re.compile(r"\s*+x(Min|Mid|Max)Y(Min|Mid|Max)(?:\s++(meet|slice))?+\s*+")
# Style declarations that move or hide elements, and escapes that may spell them.
MOVING = re.compile(
    r"@import|\\|(?<![\w-])(?:(?:transform(?:-\w++)?|translate|rotate|scale|zoom|offset(?:-\w++)?|d|x|y)\s*+:"
    r"|visibility\s*+:\s*+(?:hidden|collapse))",
    re.IGNORECASE,
)
HIDING = re.compile(r"display\s*+:\s*+none", re.IGNORECASE)


class AffineMap(NamedTuple):
    """An affine map of the plane: z -> p z + q conj(z) + r."""

    p: complex = 1
    q: complex = 0
    r: complex = 0

    def place(self, z: Complex) -> Complex:
        """The points after the map."""
        return self.p * z + self.q * np.conj(z) + self.r

    def after(self, first: AffineMap) -> AffineMap:
        """The composition: first `first`, then this map."""
        p, q, r = first
        return AffineMap(
            self.p * p + self.q * q.conjugate(),
            self.p * q + self.q * p.conjugate(),
            self.p * r + self.q * r.conjugate() + self.r,
        )


def drawing_points(text: str, count: int) -> Complex:
    """Points (count,), mm, y up, at equal lengths along the first subpath of the first visible path.

    The drawing's upper left corner is 0. A width or height with a unit sets the size, with one pixel as 1/96 inch;
    otherwise a user unit is 1 mm. DesignError, field `file`, for anything unsupported.
    """
    root = tree_of(text)
    found = _Drawing(root).first_path()
    if found is None:
        tags = {tag_of(element) for element in root.iter()}
        other = next((f", but {with_article(shape)}" for shape in SHAPES if shape in tags), "")
        raise _refused(f"it has no visible path{other}", "turn an object into a path")
    data, placement = found
    try:
        line, closed = first_subpath(data)
        line = placement.place(line)
        if not (np.abs(line) < FARTHEST).all():
            raise DesignError(
                "path", "has points too far away", f"give places within {mm(FARTHEST):g} of 0", "out-of-range"
            )
        return evenly_spaced(line, closed, count)[0]
    except DesignError as error:
        raise _refused(f"its path {marked(error.problem)}", error.remedy) from None


def _refused(problem: str, remedy: str = "save it as plain SVG without that") -> DesignError:
    return DesignError("file", problem, remedy, "file-unreadable")


def tree_of(text: str) -> ElementTree.Element:
    """The elements of an XML text without declarations and with a limited number of elements."""
    if declared := re.search(r"<!(?:ENTITY|ATTLIST|ELEMENT|NOTATION)", text):
        raise _refused(f"it declares {declared.group()}")
    if text.count("<") > 2 * MOST_ELEMENTS or text.count("=") > 10 * MOST_ELEMENTS:
        raise _refused(f"it has more than {MOST_ELEMENTS:,} elements", "save the path alone")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise _refused(f"it is not XML ({error})", "give an SVG drawing") from None
    if tag_of(root) != "svg":
        raise _refused(f"it is no SVG drawing but <{printable(tag_of(root), 30)}>", "give an SVG drawing")
    return root


def tag_of(element: ElementTree.Element) -> str:
    """The tag of an element without the namespace of SVG."""
    return element.tag.removeprefix(SVG)


class _Drawing:
    """A drawing searched for its first path."""

    def __init__(self, root: ElementTree.Element):
        self.root = root
        self.by_id: dict[str, ElementTree.Element] = {}
        self.visits = 0
        for element in root.iter():
            self.by_id.setdefault(element.get("id", ""), element)
            if tag_of(element) == "style":
                sheet = "".join(element.itertext())
                if found := MOVING.search(sheet) or HIDING.search(sheet):
                    raise _refused(f"its style sheet holds {shown(found.group())}")

    def first_path(self) -> tuple[str, AffineMap] | None:
        """The text of the first visible path and its placement."""
        if "transform" in self.root.attrib:
            raise _refused("its <svg> has a transform")
        if not _visible(self.root):
            return None
        return self._among(self.root, view_of(self.root), [self.root])

    def _among(
        self, elements: Iterable[ElementTree.Element], placement: AffineMap, above: list[ElementTree.Element]
    ) -> tuple[str, AffineMap] | None:
        """The first path of several elements inside or used by the elements `above`."""
        return next((found for element in elements if (found := self._of(element, placement, above))), None)

    def _of(
        self, element: ElementTree.Element, placement: AffineMap, above: list[ElementTree.Element]
    ) -> tuple[str, AffineMap] | None:
        """The first path of an element."""
        self.visits += 1
        if self.visits > MOST_VISITS:
            raise _refused(f"more than {MOST_VISITS:,} elements come before its first path", "save the path alone")
        if len(above) > DEEPEST:
            raise _refused(f"its elements lie more than {DEEPEST} deep in each other", "ungroup them")
        tag = tag_of(element)
        if tag == "switch":
            raise _refused("it holds a <switch>")
        # Symbols are drawn only if they are used; clip paths, masks, markers, patterns and definitions are never drawn.
        if tag not in DRAWN or (tag == "symbol" and tag_of(above[-1]) != "use") or not _visible(element):
            return None
        if "transform" in element.attrib:
            placement = placement.after(transform_of(element.get("transform", "")))
        if tag == "path":
            data = element.get("d", "none")
            return (data, placement) if data.strip() not in ("", "none") else None
        if tag in ("svg", "symbol") and "viewBox" in element.attrib:
            raise _refused(f"its inner <{tag}> has a viewBox")
        if tag in ("svg", "use"):
            placement = placement.after(AffineMap(r=complex(_pixels(element, "x"), _pixels(element, "y"))))
        below = [self._used(element)] if tag == "use" else element
        if tag == "use" and any(ancestor is below[0] for ancestor in above):
            raise _refused(f"it uses {shown(below[0].get('id'))} within itself")
        return self._among(below, placement, [*above, element])

    def _used(self, use: ElementTree.Element) -> ElementTree.Element:
        """The element shown by a use."""
        name = use.get("href", use.get(HREF, "")).strip()
        target = self.by_id.get(name[1:]) if len(name) > 1 and name[0] == "#" else None
        if target is None:
            raise _refused(f"it uses {shown(name)}, which is no id in it", "save the path itself")
        return target


def _visible(element: ElementTree.Element) -> bool:
    """Whether an element is drawn; DesignError for one moved by a style."""
    name, style = f"<{printable(tag_of(element), 30)}>", element.get("style", "")
    if found := MOVING.search(style):
        raise _refused(f"its {name} has a style with {shown(found.group())}")
    if "transform-origin" in element.attrib:
        raise _refused(f"its {name} has a transform-origin")
    if element.get("visibility", "visible") not in ("visible", "inherit"):
        raise _refused(f"its {name} has visibility = {shown(element.get('visibility'))}")
    if "display" in style:
        return not HIDING.search(style)
    return element.get("display", "").strip() != "none"


def _numbers(text: str | None, counts: tuple[int, ...], what: str) -> list[float]:
    """The numbers of an attribute in one of the allowed counts."""
    if text is not None and len(text) <= LONGEST_ATTRIBUTE and NUMBERS.fullmatch(text):
        numbers = [float(number) for number in re.findall(NUMBER, text)]
        if len(numbers) in counts and all(abs(number) <= FARTHEST for number in numbers):
            return numbers
    allowed = " or ".join(map(str, counts))
    raise _refused(f"its {what} holds {shown(text)}", f"give {allowed} numbers within {FARTHEST:g} of 0")


def _matrix(a: float, b: float, c: float, d: float, e: float, f: float) -> AffineMap:
    """x' = a x + c y + e, y' = b x + d y + f."""
    return AffineMap(complex(a + d, b - c) / 2, complex(a - d, b + c) / 2, complex(e, f))


def transform_of(text: str) -> AffineMap:
    """The placement of the attribute `transform`."""
    placement, at = AffineMap(), 0
    while at < len(text.rstrip()):
        found = TRANSFORM.match(text, at)
        if len(text) > LONGEST_ATTRIBUTE or found is None or found.group(1) not in TRANSFORMS:
            raise _refused(f"its transform holds {shown(text[at : at + 60])}", f"give {', '.join(TRANSFORMS)}")
        name, numbers = found.group(1), _numbers(found.group(2), TRANSFORMS[found.group(1)], found.group(1))
        at = found.end()
        placement = placement.after(_one_transform(name, numbers))
    return placement


def _one_transform(name: str, numbers: list[float]) -> AffineMap:
    first, *rest = numbers
    if name == "matrix":
        return _matrix(first, *rest)
    if name == "translate":
        return AffineMap(r=complex(first, *rest))
    if name == "scale":
        return _matrix(first, 0, 0, rest[0] if rest else first, 0, 0)
    if name == "rotate":
        turn, centre = complex(np.exp(1j * np.radians(first))), complex(*rest)
        return AffineMap(turn, r=centre - turn * centre)
    slope = float(np.tan(np.radians(first)))
    return _matrix(1, 0, slope, 1, 0, 0) if name == "skewX" else _matrix(1, slope, 0, 1, 0, 0)


def _length(element: ElementTree.Element, key: str) -> tuple[float, str]:
    """A length in pixels, and its unit as written."""
    text = element.get(key, "0")
    found = LENGTH.fullmatch(text) if len(text) <= LONGEST_ATTRIBUTE else None
    if found is None or found.group(2).lower() not in PIXELS:
        units = ", ".join(unit for unit in PIXELS if unit)
        raise _refused(f"its {key} is {shown(text)}", f"give a number alone or with one of {units}")
    unit = found.group(2).lower()
    return _numbers(found.group(1), (1,), key)[0] * PIXELS[unit], unit


def _pixels(element: ElementTree.Element, key: str) -> float:
    return _length(element, key)[0]


def view_of(root: ElementTree.Element) -> AffineMap:
    """The map from the drawing's user units to mm from its upper left corner."""
    sizes: dict[str, float] = {}
    scale = 1.0
    for key in ("width", "height"):
        if root.get(key, "auto").strip() in ("auto", "100%"):
            continue
        sizes[key], unit = _length(root, key)
        if sizes[key] <= 0:
            raise _refused(f"its {key} is {shown(root.get(key))}", f"give a {key} above 0")
        scale = MM_PER_PIXEL if unit else scale
    if "viewBox" not in root.attrib:
        return AffineMap(scale)
    x, y, wide, high = _numbers(root.get("viewBox"), (4,), "viewBox")
    if not (wide > 0 and high > 0):
        raise _refused(f"its viewBox is {shown(root.get('viewBox'))}", "give it a width and a height above 0")
    width = sizes.get("width", sizes.get("height", high) / high * wide)
    height = sizes.get("height", sizes.get("width", wide) / wide * high)
    across, down = width / wide, height / high
    alignment = root.get("preserveAspectRatio", "xMidYMid")
    if alignment.strip() == "none":
        return AffineMap(scale).after(_matrix(across, 0, 0, down, -x * across, -y * down))
    found = ALIGNMENT.fullmatch(alignment)
    if found is None:
        raise _refused(f"its preserveAspectRatio is {shown(alignment)}", "give none or such as xMidYMid meet")
    both = max(across, down) if found.group(3) == "slice" else min(across, down)
    shares = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
    left, top = (width - both * wide) * shares[found.group(1)], (height - both * high) * shares[found.group(2)]
    return AffineMap(scale).after(_matrix(both, 0, 0, both, left - x * both, top - y * both))
