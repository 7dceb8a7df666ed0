"""What families find is the whole thing, and evenly sampled: round the cam, from tip to tip, from end to end."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.tradeoff.families import FAMILIES
from geomkin.tradeoff.families import file_writing as files
from tests.tradeoff.test_curve_families import found, problem

CAM = problem("cam-profile").cam().profile


@pytest.mark.parametrize(
    ("method", "setting"),
    [("closed form", np.nan), ("normals by differences", 90), ("offset of the pitch polygon", 90),
     ("envelope by polygons", 90)],
)  # fmt: skip
def test_a_cam_s_profile_goes_once_all_round(method, setting):
    line = found("cam-profile", method, setting)
    z = np.asarray(line.vertices)
    steps = np.roll(z, -1) - z
    count = 360 if method == "closed form" else 90
    assert line.closed and len(z) > 0.9 * count
    # No edge is longer than three even ones, and together they are as long as the curve.
    length = np.abs(np.diff(CAM.point(np.linspace(CAM.breaks[0], CAM.breaks[-1], 20001)))).sum()
    assert np.abs(steps).max() < 3 * length / count and np.abs(steps).sum() == pytest.approx(length, rel=0.02)
    assert abs(gk.area(line)) == pytest.approx(abs(gk.area(CAM)), rel=0.01)
    assert abs(np.angle(np.roll(z, -1) / z).sum()) == pytest.approx(2 * np.pi)


@pytest.mark.parametrize(("method", "count"), [("law of gearing", np.nan), ("sampled distances", 80.0)])
def test_conjugate_space_is_sampled_from_end_to_end(method, count):
    """Of each height between root and tip there is some, not some ends alone."""
    tooth, z = problem("conjugate-tooth"), found("conjugate-tooth", method, count)
    sides = [z[np.angle(z / -1j) > 0]] + [z[np.angle(z / -1j) < 0]] * (method == "law of gearing")
    for side in sides:
        radii = np.sort(np.abs(side))
        assert radii[0] < tooth.mate_radius - 0.9 * tooth.module and radii[-1] > tooth.tip_radius - 0.05 * tooth.module
        assert np.diff(radii).max() < 0.1 * 2.2 * tooth.module
    # As wide at the pitch circle as the tooth is thick there: half a pitch, and no backlash.
    for side in sides:
        at = np.argmin(np.abs(np.abs(side) - tooth.mate_radius))
        assert abs(np.angle(side[at] / -1j)) * tooth.mate_radius == pytest.approx(np.pi * tooth.module / 4, abs=0.1)


def test_root_and_flank_have_equally_many_points():
    z = found("gear-root", "exact curves", np.nan).vertices
    gear = problem("gear-root").gear()
    assert len(z) == 100
    for part in (z[:50], z[50:]):
        assert np.abs(np.diff(part)).max() < 4 * np.abs(part[-1] - part[0]) / 49
    assert abs(z[0]) == pytest.approx(gear.root_radius) and abs(z[-1]) == pytest.approx(gear.tip_radius)
    assert abs(z[49] - z[50]) < 1e-9


@pytest.mark.parametrize("name", ["cam-flattening", "gear-flattening"])
@pytest.mark.parametrize("method", ["equal errors", "halving", "greedy"])
def test_flattened_curves_begin_and_end_where_the_curve_does(name, method):
    curve, line = problem(name).curve(), found(name, method, 0.1)
    z = np.asarray(line.vertices)
    assert line.closed == curve.closed and z[0] == pytest.approx(complex(curve.point(curve.breaks[0])), abs=1e-9)
    if not curve.closed:
        assert z[-1] == pytest.approx(complex(curve.point(curve.breaks[-1])), abs=1e-9)
    length = np.abs(np.diff(curve.point(np.linspace(curve.breaks[0], curve.breaks[-1], 20001)))).sum()
    walked = np.abs(np.diff(line.point(np.linspace(line.breaks[0], line.breaks[-1], 20001)))).sum()
    assert walked == pytest.approx(length, rel=0.02)


@pytest.mark.parametrize(("method", "setting"), [("chords", 0.01), ("even parameters", 16.0), ("bare", 0.01)])
def test_solids_of_a_gear_are_closed_and_stand_on_the_ground(method, setting):
    """Each edge of a triangle is another one's, the other way round."""
    solid = found("stl-writing", method, setting)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    corners = np.frombuffer(solid, record, offset=84)["corners"]
    assert len(corners) == int.from_bytes(solid[80:84], "little")
    edges = {(tuple(a), tuple(b)) for one in corners.tolist() for a, b in zip(one, one[1:] + one[:1])}
    assert len(edges) == 3 * len(corners) and all((b, a) in edges for a, b in edges)
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    assert (low[2], high[2]) == (0, files.THICKNESS) and high[0] - low[0] == pytest.approx(28, abs=0.5)


def test_size_of_files_is_that_of_their_contents():
    """A row of a table, a whole drawing, a whole solid."""
    assert {name for name, family in FAMILIES.items() if family.weighed == "bytes"} == {
        "csv-writing", "dxf-writing", "stl-writing",
    }  # fmt: skip
    for name, share in (("csv-writing", files.ROWS), ("dxf-writing", 1), ("stl-writing", 1)):
        assert FAMILIES[name].weigh(None, b"x" * 6000) == 6000 / share
    assert FAMILIES["csv-writing"].count(None, b"") == files.ROWS


@pytest.mark.parametrize("digits", [4.0, 6.0])
def test_a_table_of_fixed_digits_has_so_many_and_its_header(digits):
    lines = found("csv-writing", "fixed digits", digits).decode().splitlines()
    assert (
        lines[0]
        == found("csv-writing", "all digits", np.nan).decode().splitlines()[0]
        == "angle_mm,x_mm,y_mm,rate_mm,ratio_mm"
    )
    cells = [re.sub(r"e.*|[-.]", "", cell).lstrip("0") for line in lines[1:] for cell in line.split(",")]
    assert len(lines) == files.ROWS + 1 and max(map(len, cells)) == digits
