"""Parts of metres: their meshes keep the tolerance in the single precision that files of meshes have."""

import re
import zipfile

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.units import UNITS
from geomkin.export.job import Job, StaticSource
from geomkin.export.mesh import rounding_error, solid, solid_cut
from geomkin.export.solids import stl, write_threemf

TOLERANCE = 0.005


def off_circle(corners, radius, centre=0j):
    """Largest distance of the arc of the corners from the exact one, where the corners and where the chords are."""
    z = corners - centre
    z = z[np.abs(np.abs(z) - radius) < 1]
    z = z[np.argsort(np.angle(z))]
    return max(np.abs(np.abs(z) - radius).max(), np.abs(np.abs((z[1:] + z[:-1]) / 2) - radius).max())


def arc_part(radius, centre=0j):
    path = gk.plane.Path(
        (
            gk.plane.Arc(centre, centre + radius * np.exp(-0.1j), 0.2),
            gk.plane.Segment(centre + radius * np.exp(0.1j), centre + 0.99 * radius),
            gk.plane.Segment(centre + 0.99 * radius, centre + radius * np.exp(-0.1j)),
        )
    )
    return gk.Part("sector", path, (), 3.0)


SIZES = {"5 m": (5e3, 0j), "20 m": (2e4, 0j), "1 m, 20 m away": (1e3, 2e4 + 1e4j)}


@pytest.mark.parametrize("name", SIZES)
def test_stl_keeps_the_tolerance(name):
    radius, centre = SIZES[name]
    content = stl(solid_cut(arc_part(radius, centre), TOLERANCE))
    corners = np.frombuffer(content[84:], dtype=np.dtype([("n", "<f4", 3), ("z", "<f4", (3, 3)), ("a", "<u2")]))["z"]
    x, y, _ = corners.reshape(-1, 3).T.astype(float)
    assert off_circle(np.unique(x + 1j * y), radius, centre) < TOLERANCE * (1 + 1e-6)


@pytest.mark.parametrize("unit", ["mm", "in"])
@pytest.mark.parametrize("radius", [3e3, 2e4])
def test_3mf_keeps_the_tolerance(tmp_path, unit, radius):
    job = Job("sector", StaticSource((arc_part(radius),)), TOLERANCE, unit=UNITS[unit])
    (tmp_path / "sector.3mf").write_bytes(*write_threemf(job).values())
    with zipfile.ZipFile(tmp_path / "sector.3mf") as package:
        text = package.read("3D/3dmodel.model").decode()
    pairs = np.array(re.findall(r'<vertex x="(\S+)" y="(\S+)"', text), dtype=float)
    length = {"mm": 1.0, "in": 25.4}[unit]
    assert off_circle(np.unique(length * (pairs @ [1, 1j])), radius) < TOLERANCE * (1 + 1e-4)


def test_corners_are_exact_in_single_precision():
    points, faces = solid(solid_cut(arc_part(2e4), TOLERANCE))
    assert (points[:, :2] == points[:, :2].astype(np.float32)).all()
    a, b, c = points[faces].swapaxes(0, 1)
    assert (np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0).all()


def test_tolerance_below_the_numbers_of_a_mesh_is_refused_with_one_that_works():
    part = arc_part(1e3, 6e4 + 0j)
    with pytest.raises(gk.DesignError) as error:
        solid_cut(part, TOLERANCE)
    advised = float(re.search(r"at least (\S+) mm", error.value.remedy)[1])
    assert TOLERANCE < advised < 4 * TOLERANCE
    assert rounding_error(solid_cut(part, advised)) <= advised / 2
