"""The first path of an SVG drawing, in mm, with groups, transforms, uses, units and the view box.

The standard library reads the XML. Unsupported elements and attributes that
move a path are refused by name. After Scalable Vector Graphics 2, chapters 5, 7 and 8.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ...core.errors import DesignError, printable, shown, with_article
from ...core.fields import FARTHEST
from ...plane.vec import Complex
from .points import evenly_spaced, first_subpath

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
                "path", "has points too far away", f"give places within {FARTHEST:g} mm of 0", "out-of-range"
            )
        return evenly_spaced(line, closed, count)[0]
    except DesignError as error:
        raise _refused(f"its path {error.problem}", error.remedy) from None


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
