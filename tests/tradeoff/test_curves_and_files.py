"""Curves are found whole and evenly sampled, files are read back as other readers do."""

import re
from dataclasses import replace

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.tradeoff.families import FAMILIES, curves
from geomkin.tradeoff.families import written_files as files
from tests.tradeoff.measured import errors, found, problem

CAM = curves.roller_cam().profile


@pytest.mark.parametrize(
    ("method", "setting"),
    [("closed form", np.nan), ("normals by differences", 90), ("offset of the pitch polygon", 90),
     ("envelope by polygons", 90)],
)  # fmt: skip
def test_profile_of_a_cam_goes_round_once(method, setting):
    line, count = found("cam-profile", method, setting), 360 if method == "closed form" else 90
    z = np.asarray(line.vertices)
    steps = np.abs(np.roll(z, -1) - z)
    assert line.closed and len(z) > 0.9 * count
    # No edge is longer than three even ones, and together they are as long as the curve.
    length = np.abs(np.diff(CAM.point(np.linspace(CAM.breaks[0], CAM.breaks[-1], 5001)))).sum()
    assert steps.max() < 3 * length / count and steps.sum() == pytest.approx(length, rel=0.02)
    assert abs(gk.area(line)) == pytest.approx(abs(gk.area(CAM)), rel=0.01)
    assert abs(np.angle(np.roll(z, -1) / z).sum()) == pytest.approx(2 * np.pi)


@pytest.mark.parametrize(
    ("method", "count"), [("law of gearing", np.nan), ("cut by booleans", 80.0), ("sampled distances", 80.0)]
)
def test_conjugate_space_is_sampled_from_end_to_end(method, count):
    z, half = found("conjugate-tooth", method, count), np.pi / curves.MATE_TEETH
    angle = np.angle(z / -1j)
    assert np.abs(angle).max() < half * (1 + 1e-9)
    for side in [z[angle > 0]] + [z[angle < 0]] * (method != "sampled distances"):
        radii = np.sort(np.abs(side))
        assert radii[0] < curves.MATE_RADIUS - 0.9 * curves.MODULE
        assert curves.MATE_TIP * (1 + 1e-12) >= radii[-1] > curves.MATE_TIP - 0.2
        # As wide at the pitch circle as the tooth is thick there: half a pitch, and no backlash.
        at = np.argmin(np.abs(np.abs(side) - curves.MATE_RADIUS))
        width = abs(np.angle(side[at] / -1j)) * curves.MATE_RADIUS
        assert width == pytest.approx(np.pi * curves.MODULE / 4, abs=0.2)
        if method != "cut by booleans":
            assert np.diff(radii).max() < 0.1 * 2.2 * curves.MODULE


@pytest.mark.parametrize(
    ("method", "setting"),
    [("exact curves", np.nan), ("polylines trimmed", 80), ("cut by booleans", 80), ("arcs", 1e-3), ("one arc", np.nan)],
)
def test_root_and_flank_go_from_the_bottom_land_to_the_tip(method, setting):
    gear, z = curves.gear(), found("gear-root", method, setting).vertices
    angle = np.angle(1j / z)
    assert angle.min() > 0 and angle.max() < np.pi / gear.teeth * (1 + 1e-9)
    assert np.abs(z[0]) == pytest.approx(gear.root_radius, abs=0.01) and abs(np.abs(z[-1]) - gear.tip_radius) < 0.5
    assert (np.diff(np.abs(z)) > -1e-9).all() and len(z) > 8
    if method == "exact curves":
        for part in (z[:50], z[50:]):
            assert len(part) == 50 and np.abs(np.diff(part)).max() < 4 * np.abs(part[-1] - part[0]) / 49


def test_missing_results_are_nan():
    # With so few points the polylines of root and flank do not intersect.
    assert found("gear-root", "polylines trimmed", 8) is None and np.isnan(errors("gear-root", None)).all()
    line = found("gear-root", "exact curves")
    off = errors("gear-root", replace(line, vertices=line.vertices * 1.001))
    assert len(off) == len(line.vertices) and off.max() == pytest.approx(0.001 * curves.gear().root_radius)


@pytest.mark.parametrize("name", ["cam-flattening", "gear-flattening"])
def test_flattened_curves_keep_their_ends_and_length_and_greedy_has_the_fewest_vertices(name):
    curve, counts = problem(name).curve(), {}
    t = np.linspace(curve.breaks[0], curve.breaks[-1], 5001)
    for method in ("equal errors", "even parameters", "halving", "greedy"):
        line = found(name, method, 0.1)
        z = np.asarray(line.vertices)
        counts[method] = len(z)
        assert line.closed == curve.closed and z[0] == pytest.approx(complex(curve.point(t[0])), abs=1e-9)
        assert curve.closed or z[-1] == pytest.approx(complex(curve.point(t[-1])), abs=1e-9)
        length = np.abs(np.diff(line.point(np.linspace(line.breaks[0], line.breaks[-1], 5001)))).sum()
        assert length == pytest.approx(np.abs(np.diff(curve.point(t))).sum(), rel=0.02)
    assert counts["equal errors"] <= 1.03 * counts["greedy"] + 4 and counts["greedy"] <= min(counts.values()) + 2
    if name == "cam-flattening":
        assert counts["halving"] > 1.2 * counts["greedy"] and counts["even parameters"] > 1.5 * counts["greedy"]


def solid_of(content):
    return np.frombuffer(content, files.TRIANGLE, offset=84)


@pytest.mark.parametrize(("method", "setting"), [("chords", 0.01), ("even parameters", 16.0), ("bare", 0.01)])
def test_solids_of_a_gear_are_closed_and_stand_on_the_ground(method, setting):
    """Each edge of a triangle is another one's, in the other direction."""
    solid = found("stl-writing", method, setting)
    corners = solid_of(solid)["corners"]
    assert len(corners) == int.from_bytes(solid[80:84], "little")
    edges = {(tuple(a), tuple(b)) for one in corners.tolist() for a, b in zip(one, one[1:] + one[:1])}
    assert len(edges) == 3 * len(corners) and all((b, a) in edges for a, b in edges)
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    assert (low[2], high[2]) == (0, files.THICKNESS) and high[0] - low[0] == pytest.approx(28, abs=0.5)


def test_bare_solids_have_outward_normals_and_the_right_volume():
    square = np.array([0, 2, 2 + 3j, 3j])
    solid = files.bare_solid(square, np.array([[0, 1, 2], [0, 2, 3]]), [square], 5.0)
    assert files.stl_volume(solid) == pytest.approx(30, rel=1e-6) and len(solid) == 84 + 50 * 12
    read = solid_of(solid)
    assert np.linalg.norm(read["normal"], axis=1) == pytest.approx(1, abs=1e-6)
    assert ((read["normal"] * (read["corners"].mean(axis=1) - [1, 1.5, 2.5])).sum(axis=1) > 0.5).all()
    for edge in np.diff(read["corners"], axis=1).transpose(1, 0, 2):
        assert (read["normal"] * edge).sum(axis=1) == pytest.approx(0, abs=1e-6)
    area = gk.area(gk.SpurGear(12, 2).outline) - np.pi * 2.5**2
    assert problem("dxf-writing").area == pytest.approx(area, rel=1e-7)


def test_drawings_are_read_as_another_reader_does(tmp_path):
    content = found("dxf-writing", "arcs", 0.01)
    (tmp_path / "gear.dxf").write_bytes(content)
    space = ezdxf.readfile(tmp_path / "gear.dxf").modelspace()
    (line,), (circle,) = space.query("LWPOLYLINE"), space.query("CIRCLE")
    rows = np.array(line.get_points("xyb"))
    ours = files.outline_in_file(content)
    assert np.abs(ours.vertices + complex(*circle.dxf.center.vec2) - rows[:, 0] - 1j * rows[:, 1]).max() < 1e-12
    assert np.array_equal(ours.bulges, rows[:, 2]) and ours.bulges.any()


def test_errors_of_a_file_are_those_of_its_worst_place():
    lines = found("csv-writing", "all digits").decode().splitlines()
    cells = lines[3].split(",")
    lines[3] = ",".join([*cells[:3], repr(float(cells[3]) - 20), cells[4]])
    off = errors("csv-writing", "\n".join([*lines, ""]).encode())
    assert len(off) == 5 * files.ROWS and off.max() == pytest.approx(0.02) and (off > 0).sum() == 1
    solid = found("stl-writing", "chords", 1e-3)
    for size, volume in ((1.01, 1.01**3 - 1), (0.99, 1 - 0.99**3)):
        grown = solid_of(solid).copy()
        grown["corners"] *= np.float32(size)
        assert errors("stl-writing", solid[:84] + grown.tobytes()) == pytest.approx(volume, abs=2e-5)
    outline = files.outline_in_file(found("dxf-writing", "chords", 0.01))
    moved = "".join(f"10\n{z.real:.9f}\n20\n{z.imag:.9f}\n" for z in 1.002 * outline.vertices)
    head = "0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\nCUT\n10\n0\n20\n0\n40\n2.5\n0\nLWPOLYLINE\n8\nCUT\n70\n1\n"
    off = errors("dxf-writing", f"{head}{moved}0\nENDSEC\n0\nEOF\n".encode())
    # Radially by 0.2 % of 10.75 to 14 mm; on flanks less of it shows.
    assert off.max() == pytest.approx(0.002 * 14, rel=0.35) and off.min() < 0.005
    assert len(off) == 4 * len(outline.vertices)


def test_weights_are_those_of_a_row_or_a_file():
    for name, share in (("csv-writing", files.ROWS), ("dxf-writing", 1), ("stl-writing", 1)):
        assert FAMILIES[name].weighed == "bytes" and FAMILIES[name].weigh(None, b"x" * 6000) == 6000 / share


@pytest.mark.parametrize("digits", [4.0, 6.0])
def test_a_table_of_fixed_digits_has_that_number_and_its_header(digits):
    lines = found("csv-writing", "fixed digits", digits).decode().splitlines()
    assert lines[0] == found("csv-writing", "all digits").decode().splitlines()[0]
    cells = [re.sub(r"e.*|[-.]", "", cell).lstrip("0") for line in lines[1:] for cell in line.split(",")]
    assert len(lines) == files.ROWS + 1 and max(map(len, cells)) == digits
