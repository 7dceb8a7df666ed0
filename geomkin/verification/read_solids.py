"""Solids read back: STL and GLB by trimesh, 3MF and the plates of STEP by the standard library."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import trimesh

from ..core.records import record
from ..plane.vec import Real
from .comparison import Mesh, merged
from .outline import LARGEST, Outline, Pen, UnreadableError

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
MODEL = "3D/3dmodel.model"
# Largest relative distortion of the edges of a mesh by its transform in an assembly.
RIGID = 1e-6
# Lengths of the units of 3MF that are written, mm.
UNITS = {"millimeter": 1.0, "inch": 25.4}


def read_stl(path: Path) -> tuple[list[Mesh], list[str], str]:
    """The mesh of an STL file, problems of the file, and its stamp."""
    mesh: Any = _loaded(path)
    triangles = np.asarray(mesh.triangles, dtype=float)
    stated = np.asarray(mesh.face_normals, dtype=float)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    turned = len(stated) == len(normals) and (np.vecdot(stated, normals) < 0).any()
    with path.open("rb") as file:
        header = file.read(80)
    stamp = header.rstrip(b"\0").decode("ascii", "replace")
    corners, faces = merged(triangles)
    problems = ["a triangle's normal points to the inside"] if turned else []
    return [Mesh(path.stem, corners, faces)], problems, stamp


def read_glb(path: Path) -> tuple[list[Mesh], list[str], str]:
    """The meshes of a GLB file in their own frames, problems of the file, and its stamp."""
    scene: Any = _loaded(path)
    meshes, problems = [], []
    for node in scene.graph.nodes_geometry:
        placed, name = scene.graph[node]
        mesh = scene.geometry[name]
        corners, faces = merged(np.asarray(mesh.vertices, dtype=float)[np.asarray(mesh.faces)])
        meshes.append(Mesh(str(name), corners, faces))
        problems += _not_rigid(1e3 * np.asarray(placed, dtype=float)[:3, :3], str(node))
    return meshes, problems, str((scene.metadata or {}).get("stamp", ""))


def _loaded(path: Path) -> Any:
    try:
        # The mesh must stay as it is in the file, without merging or repairs.
        loaded = trimesh.load(path, process=False)
        if not np.isfinite(loaded.bounds).all():
            raise ValueError("not finite")
    except Exception as fault:
        # The library lets many kinds of error through when a file is damaged.
        raise UnreadableError(f"it is damaged, or has another format than {path.suffix[1:].upper()}") from fault
    return loaded


def _not_rigid(matrix: Real, name: str) -> list[str]:
    turned = np.abs(matrix @ matrix.T - np.eye(3)).max() < RIGID and np.linalg.det(matrix) > 0
    return [] if turned else [f"{name} is distorted or mirrored by its transform"]


def read_3mf(path: Path) -> tuple[list[Mesh], dict[str, int], list[str], str]:
    """The meshes of a 3MF package, how many times each is built, problems of the file, and its stamp."""
    try:
        with zipfile.ZipFile(path) as package:
            inside = package.getinfo(MODEL)
            # Before it is unpacked: a small package may hold a very large text.
            if inside.file_size > LARGEST:
                raise UnreadableError(f"its model has more than {LARGEST:,} bytes")
            text = package.read(MODEL)
        if b"<!" in text:
            raise UnreadableError("its model has a declaration")
        root = ElementTree.fromstring(text)
        unit = root.get("unit", "millimeter")
        length = UNITS.get(unit, 1.0)
        meshes = {item.get("id", ""): mesh for item in root.iter(f"{CORE}object") if (mesh := _mesh(item, length))}
    except (OSError, KeyError, ValueError, TypeError, zipfile.BadZipFile, ElementTree.ParseError) as fault:
        raise UnreadableError(f"it is not a 3MF package ({type(fault).__name__})") from None
    problems = [] if unit in UNITS else [f"its unit is {unit}, not {' or '.join(UNITS)}"]
    counts: dict[str, int] = {}
    placed = [*root.iter(f"{CORE}component"), *root.iter(f"{CORE}item")]
    for item in (item for item in placed if item.get("objectid") in meshes):
        name = meshes[item.get("objectid", "")].name
        counts[name] = counts.get(name, 0) + 1
        numbers = [float(number) for number in item.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()]
        if len(numbers) != 12:
            raise UnreadableError("a transform has not 12 numbers")
        problems += _not_rigid(np.array(numbers).reshape(4, 3)[:3], name)
    stamps = [item.text or "" for item in root.iter(f"{CORE}metadata") if item.get("name") == "Description"]
    return list(meshes.values()), counts, problems, stamps[0] if stamps else ""


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
    """The loops of the lower and of the upper face of a plate, mm, and the height of the upper face, mm."""

    lower: tuple[Outline, ...]
    upper: tuple[Outline, ...]
    thickness: float
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
    with path.open("rb") as stream:
        content = stream.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise UnreadableError(f"it has more than {LARGEST:,} bytes")
    try:
        file = _File(content.decode("ascii"))
        return _plate(file, error)
    except (UnicodeDecodeError, ValueError, IndexError, RecursionError) as fault:
        raise UnreadableError(f"it is not a STEP file of a plate ({type(fault).__name__})") from None


def _plate(file: _File, error: float) -> StepPlate:
    units = [text for kind, text in file.entities.values() if not kind and "LENGTH_UNIT" in text]
    if len(units) != 1 or "SI_UNIT(.MILLI.,.METRE.)" not in units[0]:
        raise UnreadableError("its unit of length is not the millimetre")
    lids: list[tuple[float, tuple[Outline, ...]]] = []
    shells = [text for kind, text in file.entities.values() if kind == "CLOSED_SHELL"]
    if len(shells) != 1:
        raise UnreadableError(f"it has {len(shells)} shells, not one")
    for face in REFERENCE.findall(shells[0]):
        *bounds, surface = file.of(face, "ADVANCED_FACE")[1]
        kind, (place, *_), _ = file.of(surface, "PLANE", "CYLINDRICAL_SURFACE")
        _, height, axis = file.placement(place)
        if kind == "PLANE" and abs(axis) > 0.5:
            lids.append((height, tuple(_loop(file, bound, height, error) for bound in bounds)))
    if len(lids) != 2:
        raise UnreadableError(f"it has {len(lids)} level faces, not two")
    (low, lower), (high, upper) = sorted(lids, key=lambda lid: lid[0])
    if abs(low) > SAME:
        raise UnreadableError(f"its lower face is at z = {low:g}, not 0")
    stamp = re.search(r"FILE_DESCRIPTION\(\('([^']*)'", file.header)
    return StepPlate(lower, upper, high, stamp.group(1) if stamp else "")


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
        bulge = _bulge(file, curve, start, end)
        if not text.rstrip().endswith(".T."):
            start, end, bulge = end, start, -bulge
        if last is not None and abs(start - last) > SAME:
            raise UnreadableError("two edges that follow each other do not meet")
        first, last = start if first is None else first, end
        pen.edge(start, end, bulge)
    if first is None or last is None or abs(first - last) > SAME:
        raise UnreadableError("a loop is not closed")
    return pen.outline(closed=True)


def _bulge(file: _File, curve: str, start: complex, end: complex) -> float:
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
