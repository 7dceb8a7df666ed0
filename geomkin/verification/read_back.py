"""Files read back: DXF by ezdxf, STL by trimesh, SVG and 3MF by the standard library."""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ..core.errors import DesignError, printable, with_article
from ..plane.vec import Complex
from ..synthesis.path.svg_drawings import AffineMap, subpaths, tag_of, transform_of, tree_of, view_of
from .made_again import NUMBER, members
from .outline import LARGEST, MOST_VERTICES, Drawing, Line, Outline, UnreadableError, circle, collected, polyline
from .solids import Mesh, merged

# Lengths of the units in which drawings are written, by their number in the format, mm.
DXF_UNITS = {1: 25.4, 4: 1.0}
# Version without a unit.
R12 = "AC1009"


def read_dxf(content: bytes, error: float, unit: float = 1.0) -> Drawing:
    """The lines of a DXF file, arcs as chords within `error`, mm. unit: of R12, which does not state its own, mm.

    UnreadableError if it is no DXF file, or has too many vertices.
    """
    from ezdxf.filemanagement import decode_base64

    problems: list[str] = []
    try:
        document = decode_base64(b64encode(content))
        entities: list[Any] = list(document.modelspace())
        if document.dxfversion != R12:
            if (units := document.header.get("$INSUNITS", 0)) not in DXF_UNITS:
                problems.append(f"its $INSUNITS is {units}, not 4 for mm or 1 for inches")
            unit = DXF_UNITS.get(units, 1.0)
        lines = collected(_dxf_lines(entities, error, problems, unit))
        problems += _wrong_extents(document, lines, error, unit)
    except UnreadableError:
        raise
    except Exception as fault:
        # The library lets many kinds of error through when a file is damaged.
        raise UnreadableError(f"ezdxf cannot read it ({type(fault).__name__})") from fault
    return Drawing(lines, document.ezdxf_metadata().get("STAMP", ""), tuple(problems))


def _dxf_lines(entities: list[Any], error: float, problems: list[str], unit: float) -> Iterator[Line]:
    """The circles and polylines; a sentence is added to `problems` for anything else. unit: of the drawing, mm."""
    for entity in entities:
        kind, layer = entity.dxftype(), entity.dxf.layer
        if kind == "CIRCLE":
            yield Line(circle(unit * _point(entity.dxf.center), unit * float(entity.dxf.radius), error), layer)
        elif kind == "POLYLINE" and entity.is_2d_polyline:
            places: Complex = np.array([_point(vertex.dxf.location) for vertex in entity.vertices], dtype=complex)
            bulges = [float(vertex.dxf.bulge) for vertex in entity.vertices]
            yield Line(polyline(unit * places, bulges, bool(entity.is_closed), error), layer)
        elif kind != "LWPOLYLINE":
            problems.append(f"it has {with_article(kind)} on layer {layer}, which geomkin does not write")
        elif len(entity) < 2:
            problems.append(f"a polyline on layer {layer} has fewer than two vertices")
        else:
            rows = np.array(entity.get_points("xyb"), dtype=float).reshape(-1, 3)
            outline = polyline(unit * (rows[:, 0] + 1j * rows[:, 1]), rows[:, 2].tolist(), bool(entity.closed), error)
            yield Line(outline, layer)


def _wrong_extents(document: Any, lines: Sequence[Line], error: float, unit: float) -> list[str]:
    """A sentence if the header's extents are not those of the lines."""
    cut = np.concatenate([line.outline.points for line in lines]) if lines else np.zeros(0, dtype=complex)
    if not len(cut):
        return ["it has no lines"]
    low, high = (unit * _point(document.header.get(name, (np.nan, np.nan))) for name in ("$EXTMIN", "$EXTMAX"))
    if low.real > high.real:
        # The library's value for extents that no program has set.
        return []
    found = np.array([cut.real.min(), cut.imag.min(), cut.real.max(), cut.imag.max()])
    stated = np.array([low.real, low.imag, high.real, high.imag])
    far = not np.all(np.abs(found - stated) <= 2 * error + 1e-6)
    return ["the extents in its header are not those of its lines"] if far else []


def _point(place: Any) -> complex:
    return complex(float(place[0]), float(place[1]))


# Operations by stroke colour, as laser cutting programs have them, for lines without a class.
COLOURS = {"#ff0000": "CUT", "#0000ff": "ENGRAVE"}
LAYERS = ("CUT", "HOLE", "ENGRAVE", "LABEL", "PITCH", "TAB")
UNIT = re.compile(r"[\d.]+(?:mm|in)")


def read_svg(content: bytes, error: float) -> Drawing:
    """The lines of an SVG file, arcs as chords within `error`, mm. UnreadableError if it is no such drawing."""
    try:
        root = tree_of(content.decode("utf-8"))
        view = view_of(root)
        lines = collected(_svg_lines(root, view, ("", ""), error, 0))
    except UnicodeDecodeError:
        raise UnreadableError("it is not UTF-8 text") from None
    except DesignError as refusal:
        named = "a path " if refusal.field == "path" else ""
        raise UnreadableError(f"{named}{refusal.problem}") from None
    problems = [
        f"its {name} is not stated in mm or in"
        for name in ("width", "height")
        if not UNIT.fullmatch(root.get(name, ""))
    ]
    if outside := sum(_is_outside(line.outline.points, root, view) for line in lines):
        problems.append(f"{outside} lines are not on the sheet")
    stamps = [element.text or "" for element in root if tag_of(element) == "desc"]
    return Drawing(lines, stamps[0] if stamps else "", tuple(problems if lines else [*problems, "it has no lines"]))


def _is_outside(points: Complex, root: Element, view: AffineMap) -> bool:
    """Whether points, mm, y up, are outside the view box of a drawing that has one."""
    if "viewBox" not in root.attrib:
        return False
    x, y, wide, high = map(float, root.get("viewBox", "").replace(",", " ").split())
    low, high_end = np.conj(view.place(np.array([complex(x, y), complex(x + wide, y + high)])))
    across, up = (points.real, low.real, high_end.real), (points.imag, high_end.imag, low.imag)
    return any(bool((values < least).any() or (values > most).any()) for values, least, most in (across, up))


def _svg_lines(element: Element, view: AffineMap, above: tuple[str, str], error: float, depth: int) -> Iterator[Line]:
    """The lines of an element and of those inside it; above: layer and name of the group that it is in."""
    if depth > 100:
        raise UnreadableError("its elements are nested more than 100 deep")
    if "transform" in element.attrib:
        view = view.after(transform_of(element.get("transform", "")))
    tag = tag_of(element)
    layer, group = _layer(element) or above[0], element.get("id", "") if tag == "g" else above[1]
    if tag == "path":
        for points, closed in subpaths(element.get("d", ""), error, MOST_VERTICES):
            is_distinct = np.append(True, points[1:] != points[:-1])
            is_distinct[-1] &= not (closed and points[-1] == points[0])
            yield Line(_placed(Outline(points[is_distinct], error, closed), view), layer or "CUT", group)
    elif tag == "circle":
        centre = complex(_number(element, "cx"), _number(element, "cy"))
        yield Line(_placed(circle(centre, _number(element, "r"), error), view), layer or "CUT", group)
    for child in element:
        yield from _svg_lines(child, view, (layer, group), error, depth + 1)


def _layer(element: Element) -> str:
    name = element.get("class", "")
    return name if name in LAYERS else COLOURS.get(element.get("stroke", "").lower(), "")


def _number(element: Element, key: str) -> float:
    text = element.get(key, "0")
    if not NUMBER.fullmatch(text):
        raise UnreadableError(f"the {key} of a circle is {printable(text, 40)}, not a number without a unit")
    return float(text)


def _placed(outline: Outline, view: AffineMap) -> Outline:
    """The outline in mm, y up, about an arbitrary origin, which does not matter for the fit of a part."""
    return Outline(np.conj(view.place(outline.points)), outline.error, outline.closed)


CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
MODEL = "3D/3dmodel.model"
# Largest relative distortion of the edges of a mesh by its transform, and the transform of an item that has none.
RIGID, UNMOVED = 1e-6, "1 0 0 0 1 0 0 0 1 0 0 0"
# Largest difference of a coordinate of a normal of unit length. Those of thin triangles have few digits.
NORMAL = 0.05
# Lengths of the units of 3MF that are written, mm.
PACKAGE_UNITS = {"millimeter": 1.0, "inch": 25.4}


def read_stl(path: Path) -> tuple[list[Mesh], list[str], str]:
    """The mesh of an STL file, problems of the file, and its stamp."""
    mesh: Any = _loaded(path)
    triangles = np.asarray(mesh.triangles, dtype=float)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    content = content_of(path)
    # The library replaces normals that are wrong.
    rows = np.frombuffer(content[84:], np.uint8)
    rows = rows.reshape(-1, 50) if len(rows) == 50 * len(normals) else np.zeros((len(normals), 50), np.uint8)
    stated = np.ascontiguousarray(rows[:, :12]).view("<f4").astype(float)
    sizes = np.sqrt(np.vecdot(normals, normals))
    wrong = int((np.abs(stated * sizes[:, None] - normals) > NORMAL * sizes[:, None]).any(axis=1).sum())
    is_binary = len(content) == 84 + 50 * len(normals)
    problems = [f"{wrong} normals are not those of their triangles"] if wrong and is_binary else []
    corners, faces = merged(triangles)
    return [Mesh(path.stem, corners, faces)], problems, content[:80].rstrip(b"\0").decode("ascii", "replace")


def _loaded(path: Path) -> Any:
    import trimesh

    try:
        # The mesh must stay as it is in the file, without merging or repairs.
        loaded = trimesh.load(path, process=False)
        if not np.isfinite(loaded.bounds).all():
            raise ValueError("not finite")
    except Exception as fault:
        # The library lets many kinds of error through when a file is damaged.
        raise UnreadableError(f"it is damaged, or has another format than {path.suffix[1:].upper()}") from fault
    return loaded


def read_3mf(path: Path) -> tuple[dict[str, Mesh], list[tuple[str, tuple[complex, complex]]], list[str], str]:
    """The meshes of a 3MF package by number, the numbers and places of those built, problems, and the stamp.

    A place is a rotation, unit complex, and a shift, mm.
    """
    text, problems = dict(members(content_of(path))).get(MODEL, ""), list[str]()
    if "<!" in text:
        raise UnreadableError("its model has a declaration")
    try:
        root = ElementTree.fromstring(text)
        unit = root.get("unit", "millimeter")
        length = PACKAGE_UNITS.get(unit, 1.0)
        meshes = {item.get("id", ""): mesh for item in root.iter(f"{CORE}object") if (mesh := _mesh(item, length))}
        items = [item for item in root.iter(f"{CORE}item") if item.get("objectid") in meshes]
        moves = [[float(number) for number in item.get("transform", UNMOVED).split()] for item in items]
        matrices = [np.array(numbers).reshape(4, 3) for numbers in moves]
    except (ValueError, TypeError, ElementTree.ParseError) as fault:
        raise UnreadableError(f"it is not a 3MF package ({type(fault).__name__})") from None
    if unit not in PACKAGE_UNITS:
        problems.append(f"its unit is {unit}, not {' or '.join(PACKAGE_UNITS)}")
    places: list[tuple[str, tuple[complex, complex]]] = []
    for item, matrix in zip(items, matrices):
        number = item.get("objectid", "")
        turn, shift = complex(*matrix[0, :2]), length * complex(*matrix[3, :2])
        flat = np.array([[turn.real, turn.imag, 0], [-turn.imag, turn.real, 0], [0, 0, 1]])
        is_flat = np.abs(matrix[:3] - flat).max() < RIGID and abs(abs(turn) - 1) < RIGID and abs(matrix[3, 2]) < RIGID
        if not (is_flat and np.isfinite(matrix).all()):
            problems.append(f"{printable(meshes[number].name, 60)} is distorted, mirrored or off the bed")
        places.append((number, (turn, shift)))
    stamps = [item.text or "" for item in root.iter(f"{CORE}metadata") if item.get("name") == "Description"]
    return meshes, places, problems, stamps[0] if stamps else ""


def _mesh(item: ElementTree.Element, unit: float) -> Mesh | None:
    corners = [[float(vertex.get(axis, "nan")) for axis in "xyz"] for vertex in item.iter(f"{CORE}vertex")]
    faces = [[int(face.get(key, "-1")) for key in ("v1", "v2", "v3")] for face in item.iter(f"{CORE}triangle")]
    if not faces:
        return None
    points, triangles = unit * np.array(corners, dtype=float), np.array(faces, dtype=int)
    if not np.isfinite(points).all() or triangles.min() < 0 or triangles.max() >= len(points):
        raise ValueError("not a mesh")
    return Mesh(item.get("name", ""), *merged(points[triangles]))


def content_of(path: Path) -> bytes:
    """The content of a file; UnreadableError for a large one."""
    with path.open("rb") as file:
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise UnreadableError(f"it has more than {LARGEST:,} bytes")
    return content
