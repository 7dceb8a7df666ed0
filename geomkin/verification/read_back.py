"""Files read back: DXF by ezdxf, STL by trimesh, SVG, 3MF and the plates of STEP by the standard library."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ..core.errors import DesignError, printable, with_article
from ..core.records import record
from ..plane.vec import Complex, Real
from ..synthesis.path.svg_drawings import AffineMap, subpaths, tag_of, transform_of, tree_of, view_of
from .comparison import Mesh, merged
from .made_again import members
from .outline import LARGEST, MOST_VERTICES, Drawing, Line, Outline, Pen, UnreadableError, circle, collected, polyline

# Lengths of the units in which drawings are written, by their number in the format, mm.
DXF_UNITS = {1: 25.4, 4: 1.0}
# Version without a unit.
R12 = "AC1009"


def read_dxf(path: Path, error: float, unit: float = 1.0) -> Drawing:
    """The lines of a DXF file, arcs as chords within `error`, mm. unit: of R12, which does not state its own, mm.

    UnreadableError if it is no DXF file, or has too many vertices.
    """
    from ezdxf.filemanagement import readfile

    problems: list[str] = []
    try:
        document = readfile(path)
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


def read_svg(path: Path, error: float) -> Drawing:
    """The lines of an SVG file, arcs as chords within `error`, mm. UnreadableError if it is no such drawing."""
    content = _content(path)
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
            if is_distinct.sum() > 1:
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
    try:
        return float(element.get(key, "0").removesuffix("mm"))
    except ValueError:
        raise UnreadableError(f"the {key} of a circle is not a number") from None


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
    content = _content(path)
    # The library replaces normals that are wrong.
    rows = np.frombuffer(content[84:], np.uint8)
    rows = rows.reshape(-1, 50) if len(rows) == 50 * len(normals) else np.zeros((len(normals), 50), np.uint8)
    stated = np.ascontiguousarray(rows[:, :12]).view("<f4").astype(float)
    sizes = np.sqrt(np.vecdot(normals, normals))
    wrong = int((np.abs(stated * sizes[:, None] - normals) > NORMAL * sizes[:, None]).any(axis=1).sum())
    problems = [f"{wrong} normals are not those of their triangles"] if wrong else []
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
    text, problems = dict(members(_content(path))).get(MODEL, ""), list[str]()
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


ENTITY = re.compile(r"#(\d+)\s*=\s*([A-Z0-9_]*)\s*\((.*)\)\s*", re.DOTALL)
REFERENCE = re.compile(r"#(\d+)")
STRING = re.compile(r"'(?:[^']|'')*'")
# Largest distance between two ends that count as meeting, and from a plane in which a point counts as lying, mm.
SAME = 1e-5


@record(eq=False)
class StepPlate:
    """The loops of the lower and of the upper face of a plate, mm, and the height of the upper face, mm.

    walls: points (n, 3) of the B-spline surfaces between them, mm.
    """

    lower: tuple[Outline, ...]
    upper: tuple[Outline, ...]
    thickness: float
    walls: Real
    stamp: str = ""


class _File:
    """The entities of a file by number."""

    def __init__(self, text: str):
        header, _, data = text.partition("DATA;")
        self.header = header
        self.entities: dict[str, tuple[str, str]] = {}
        # Texts, which are not needed, may contain semicolons and numbers.
        for line in STRING.sub("''", data).split(";"):
            if found := ENTITY.fullmatch(line.strip()):
                self.entities[found.group(1)] = (found.group(2), found.group(3))

    def of(self, number: str, *kinds: str) -> tuple[str, list[str], str]:
        """Kind, references and text of an entity, which must be of one of these kinds."""
        kind, text = self.entities.get(number, ("nothing", ""))
        if kind not in kinds:
            raise UnreadableError(f"entity #{number} is {kind or 'a list'}, not {' or '.join(kinds)}")
        return kind, REFERENCE.findall(text), text

    def point(self, number: str) -> tuple[complex, float]:
        """Position in the plane and height of a point."""
        x, y, z = _numbers(self.of(number, "CARTESIAN_POINT")[2])
        return complex(x, y), z

    def placement(self, number: str) -> tuple[complex, float, float]:
        """Origin in the plane, height and z component of the axis of a placement."""
        centre, axis, _ = self.of(number, "AXIS2_PLACEMENT_3D")[1]
        return *self.point(centre), _numbers(self.of(axis, "DIRECTION")[2])[2]


def read_step(path: Path, error: float) -> StepPlate:
    """The plate in a STEP file, arcs as chords within `error`, mm. UnreadableError if it holds anything else."""
    content = _content(path)
    try:
        return _plate(_File(content.decode("ascii")), error)
    except (UnicodeDecodeError, ValueError, IndexError, RecursionError) as fault:
        raise UnreadableError(f"it is not a STEP file of a plate ({type(fault).__name__})") from None


def _plate(file: _File, error: float) -> StepPlate:
    units = [text for kind, text in file.entities.values() if not kind and "LENGTH_UNIT" in text]
    if len(units) != 1 or "SI_UNIT(.MILLI.,.METRE.)" not in units[0]:
        raise UnreadableError("its unit of length is not the millimetre")
    lids: list[tuple[float, tuple[Outline, ...]]] = []
    walls: list[Real] = []
    shells = [text for kind, text in file.entities.values() if kind == "CLOSED_SHELL"]
    if len(shells) != 1:
        raise UnreadableError(f"it has {len(shells)} shells, not one")
    for face in REFERENCE.findall(shells[0]):
        *bounds, surface = file.of(face, "ADVANCED_FACE")[1]
        kind, (place, *_), _ = file.of(surface, *SURFACES)
        if kind == "B_SPLINE_SURFACE_WITH_KNOTS":
            walls.append(_surface_points(file, surface))
        if kind != "PLANE":
            continue
        _, height, axis = file.placement(place)
        if abs(axis) > 0.5:
            lids.append((height, tuple(_loop(file, bound, height, error) for bound in bounds)))
    if len(lids) != 2:
        raise UnreadableError(f"it has {len(lids)} level faces, not two")
    (low, lower), (high, upper) = sorted(lids, key=lambda lid: lid[0])
    if abs(low) > SAME:
        raise UnreadableError(f"its lower face is at z = {low:g}, not 0")
    stamp = re.search(r"FILE_DESCRIPTION\(\('([^']*)'", file.header)
    points = np.concatenate([np.zeros((0, 3)), *walls])
    return StepPlate(lower, upper, high, points, stamp.group(1) if stamp else "")


def _loop(file: _File, bound: str, height: float, error: float) -> Outline:
    (ring,) = file.of(bound, "FACE_BOUND", "FACE_OUTER_BOUND")[1]
    pen = Pen(error)
    last: complex | None = None
    first: complex | None = None
    for oriented in file.of(ring, "EDGE_LOOP")[1]:
        _, (edge,), text = file.of(oriented, "ORIENTED_EDGE")
        _, (start_number, end_number, curve), _ = file.of(edge, "EDGE_CURVE")
        ends = [file.point(file.of(number, "VERTEX_POINT")[1][0]) for number in (start_number, end_number)]
        if any(abs(z - height) > SAME for _, z in ends):
            raise UnreadableError("an edge of a level face leaves its plane")
        (start, _), (end, _) = ends
        is_forward = text.rstrip().endswith(".T.")
        spline = _curve_points(file, curve, error) if file.entities.get(curve, ("",))[0] == SPLINE else None
        bulge = 0.0 if spline is not None else _step_bulge(file, curve, start, end)
        if spline is not None and max(abs(spline[0] - start), abs(spline[-1] - end)) > SAME:
            raise UnreadableError("a B-spline does not begin or end at its edge")
        if not is_forward:
            start, end, bulge = end, start, -bulge
        if last is not None and abs(start - last) > SAME:
            raise UnreadableError("two edges that follow each other do not meet")
        first, last = start if first is None else first, end
        if spline is not None:
            pen.add(spline[:-1] if is_forward else spline[:0:-1])
        else:
            pen.edge(start, end, bulge)
    if first is None or last is None or abs(first - last) > SAME:
        raise UnreadableError("a loop is not closed")
    return pen.outline(closed=True)


SPLINE = "B_SPLINE_CURVE_WITH_KNOTS"
SURFACES = ("PLANE", "CYLINDRICAL_SURFACE", "SURFACE_OF_LINEAR_EXTRUSION", "B_SPLINE_SURFACE_WITH_KNOTS")
# Points between two knots of a surface.
GRID = 5


def _lists(text: str) -> list[str]:
    """The lists of an entity that contain no other list, without their parentheses."""
    return re.findall(r"\(([^()]*)\)", text)


def _knot_row(counts: str, values: str) -> Real:
    """Knots, each as often as its multiplicity."""
    return np.repeat(_numbers(values), [int(count) for count in counts.split(",")])


def _evaluated(knots: Real, controls: Any, t: Real) -> Any:
    """Points of a cubic B-spline at parameters, along the first axis of its control points, by de Boor's algorithm."""
    k = np.clip(np.searchsorted(knots, t, side="right") - 1, 3, len(controls) - 1)
    corners = [controls[k - 3 + j] for j in range(4)]
    for r in range(1, 4):
        for j in range(3, r - 1, -1):
            low, high = knots[k - 3 + j], knots[k + 1 + j - r]
            share = ((t - low) / (high - low)).reshape(-1, *[1] * (controls.ndim - 1))
            corners[j] = (1 - share) * corners[j - 1] + share * corners[j]
    return corners[3]


def _between(knots: Real, count: int) -> Real:
    """Parameters in equal steps between the knots, so many from one to the next, with the last one."""
    distinct = np.unique(knots)
    inner = distinct[:-1, None] + np.diff(distinct)[:, None] * np.arange(count) / count
    return np.append(inner.ravel(), distinct[-1])


def _curve_points(file: _File, curve: str, error: float) -> Complex:
    """Points of a cubic B-spline, its chords within `error`, mm."""
    _, references, text = file.of(curve, SPLINE)
    _, counts, values = _lists(text)
    if text.partition(",")[2].partition(",")[0] != "3":
        raise UnreadableError("a B-spline is not cubic")
    knots, controls = _knot_row(counts, values), np.array([file.point(number)[0] for number in references])
    for count in (2, 4, 8, 16, 32, 64, 128, 256, 512, 1024):
        points: Complex = _evaluated(knots, controls, _between(knots, 2 * count))
        chords = (points[:-2:2] + points[2::2]) / 2
        if np.abs(points[1::2] - chords).max() < error:
            break
    return points


def _surface_points(file: _File, surface: str) -> Real:
    """Points of a bicubic B-spline surface, mm."""
    _, references, text = file.of(surface, SURFACES[-1])
    *rows, first_counts, second_counts, first, second = _lists(text)
    points = [file.point(number) for number in references]
    net = np.array([(z.real, z.imag, height) for z, height in points]).reshape(len(rows), -1, 3)
    along, up = (_knot_row(*pair) for pair in ((first_counts, first), (second_counts, second)))
    lines = _evaluated(along, net, _between(along, GRID)).swapaxes(0, 1)
    found: Real = _evaluated(up, lines, _between(up, GRID)).reshape(-1, 3)
    return found


def _step_bulge(file: _File, curve: str, start: complex, end: complex) -> float:
    """Tangent of a quarter of the sweep of an edge; 0 if it is straight."""
    kind, (place, *_), text = file.of(curve, "LINE", "CIRCLE")
    if kind == "LINE":
        return 0.0
    centre, _, axis = file.placement(place)
    radius = _numbers(text.rpartition(",")[2])[0]
    if max(abs(abs(z - centre) - radius) for z in (start, end)) > SAME:
        raise UnreadableError("an arc does not begin or end on its circle")
    # Counterclockwise about the axis of the circle.
    sweep = float(np.angle((end - centre) / (start - centre)))
    sweep = sweep % (2 * np.pi) if axis > 0 else -((-sweep) % (2 * np.pi))
    return float(np.tan(sweep / 4))


def _numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"[-+]?\d+\.?\d*(?:E[-+]?\d+)?", text)]


def _content(path: Path) -> bytes:
    with path.open("rb") as file:
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise UnreadableError(f"it has more than {LARGEST:,} bytes")
    return content
