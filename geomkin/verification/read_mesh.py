"""STL and GLB read back by trimesh, 3MF by the standard library."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import trimesh

from ..plane.vec import Real
from .drawing import LARGEST, UnreadableError
from .solid import Mesh, merged

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
