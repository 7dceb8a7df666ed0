"""Families of curves, gears, syntheses and files: each method finds the thing, and the references are right."""

import csv
import io
from dataclasses import replace
from functools import cache

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.plane.vec import Pose
from geomkin.tradeoff.families import FAMILIES
from geomkin.tradeoff.families import file_writing as files
from geomkin.tradeoff.families import function_synthesis as functions
from geomkin.tradeoff.families import path_synthesis as paths
from geomkin.tradeoff.families.curve_flattening import by_doubling, by_halving, greedy
from geomkin.tradeoff.family import Tool
from geomkin.tradeoff.files import chart_files

from .toy import CHART

# Of each method at one setting: an error that it stays below, and if it can be estimated, one that it does not.
REACHED = {
    ("cam-flattening", "equal errors", 0.01): (0.01, 0.009),
    ("cam-flattening", "even parameters", 0.01): (0.01, 0.002),
    ("cam-flattening", "halving", 0.01): (0.01, 0.008),
    ("cam-flattening", "greedy", 0.1): (0.1001, 0.09),
    ("cam-flattening", "arcs", 0.01): (0.01, 0.005),
    ("gear-flattening", "equal errors", 1e-3): (1e-3, 9e-4),
    ("gear-flattening", "even parameters", 1e-3): (1e-3, 2e-4),
    ("gear-flattening", "halving", 1e-3): (1e-3, 5e-4),
    ("gear-flattening", "greedy", 0.01): (0.01001, 0.009),
    ("gear-flattening", "arcs", 1e-3): (1e-3, 5e-4),
    ("cam-profile", "closed form", np.nan): (1e-12, 0),
    ("cam-profile", "normals by differences", 360): (2e-7, 1e-8),
    ("cam-profile", "offset of the pitch polygon", 360): (1e-3, 1e-4),
    ("cam-profile", "envelope by polygons", 360): (0.03, 0.01),
    ("gear-root", "exact curves", np.nan): (1e-12, 0),
    ("gear-root", "polylines trimmed", 80): (2e-4, 1e-5),
    ("gear-root", "cut by booleans", 80): (3e-3, 5e-4),
    ("gear-root", "arcs", 1e-3): (1e-3, 5e-4),
    # What a drawing's fillet leaves where the rack undercuts.
    ("gear-root", "one arc", np.nan): (0.2, 0.1),
    ("conjugate-tooth", "law of gearing", np.nan): (5e-12, 0),
    ("conjugate-tooth", "cut by booleans", 160): (0.01, 0.001),
    ("conjugate-tooth", "sampled distances", 160): (0.01, 0.001),
    ("function-synthesis", "three points by hand", 1024): (0.1, 0.0901),
    ("path-synthesis", "fits alone", 1000): (0.03, 0.0224),
    ("csv-writing", "ten digits", np.nan): (5e-10, 1e-11),
    ("csv-writing", "fixed digits", 6): (1e-6, 1e-7),
    ("csv-writing", "all digits", np.nan): (0, 0),
    ("dxf-writing", "chords", 0.01): (0.01, 0.008),
    ("dxf-writing", "arcs", 0.01): (0.01, 0.004),
    ("dxf-writing", "bare", 0.01): (0.01, 0.008),
    ("stl-writing", "chords", 0.01): (2e-4, 1e-5),
    ("stl-writing", "even parameters", 16): (3e-4, 1e-5),
    ("stl-writing", "bare", 0.01): (2e-4, 1e-5),
}
# They take seconds.
LONG = {
    ("function-synthesis", "minimax", np.nan): (0.046931, 0.04692),
    ("function-synthesis", "least squares", np.nan): (0.11, 0.1),
    ("function-synthesis", "three points searched", np.nan): (0.0901, 0.0469),
    ("function-synthesis", "four points searched", np.nan): (0.092, 0.0469),
    ("path-synthesis", "search", np.nan): (0.022397, 0.022396),
    ("path-synthesis", "fits improved", 10): (0.0225, 0.022396),
}


@cache
def problem(name):
    return FAMILIES[name].problem()


def found(name, method, setting):
    (one,) = [m for m in FAMILIES[name].methods if m.name == method]
    return one.make(problem(name), setting)()


def check(name, method, setting, least, most):
    errors = FAMILIES[name].error(problem(name), found(name, method, setting))
    assert np.isfinite(errors).all() and least <= errors.max() <= most


@pytest.mark.parametrize(("name", "method", "setting"), REACHED, ids=str)
def test_each_method_finds_the_thing(name, method, setting):
    check(name, method, setting, *REACHED[name, method, setting][::-1])


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "method", "setting"), LONG, ids=str)
def test_each_search_finds_the_thing(name, method, setting):
    check(name, method, setting, *LONG[name, method, setting][::-1])


def test_every_method_is_tried():
    tried = {(name, method) for name, method, _ in (*REACHED, *LONG)}
    ours = {name for name, _ in tried}
    assert tried == {(f.name, m.name) for f in FAMILIES.values() if f.name in ours for m in f.methods}


# The references


def test_clearance_of_a_roller_on_a_circle_and_of_a_square_that_slides():
    def round_and_round(t):
        return Pose(50 * np.exp(1j * t), np.exp(7j * t))

    z = np.array([3, 20, 39.9, 40, 41, 59]) * np.exp(1j * np.arange(6))
    roller = Tool(np.array([0j]), 10.0, round_and_round, (0.0, 2 * np.pi))
    assert roller.clearance(z) == pytest.approx(np.abs(np.abs(z) - 50) - 10, abs=1e-12)
    # A square of 2 mm, rounded by 0.5, that goes 10 mm along +x: what it sweeps is as long as that and wider by it.
    square = Tool(
        np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j]),
        0.5,
        lambda t: Pose(t + 0j, np.ones(t.shape, complex)),
        (0.0, 10.0),
    )
    z = np.array([5 + 3j, 5 + 1.5j, 15 + 0j, 12 + 2j, -4 - 4j, 5 + 1j])
    off = [1.5, 0, 3.5, np.sqrt(2) - 0.5, np.hypot(3, 3) - 0.5, -0.5]
    assert square.clearance(z) == pytest.approx(off, abs=1e-12)


def test_the_rack_cuts_an_undercut_tooth_at_its_known_radius():
    """Cut-in radius of 12 teeth of module 2: below it the involute is gone, above it the rack touches it."""
    tool, gear = problem("gear-root").tool, gk.SpurGear(12, 2)
    base, half = gear.base_radius, (np.pi / 2) / 12 + np.tan(np.radians(20)) - np.radians(20)
    for radius, sign in ((11.29, -1), (11.302702044909595, 0), (11.5, 0), (13.9, 0)):
        roll = np.sqrt((radius / base) ** 2 - 1)
        z = radius * 1j * np.exp(-1j * (half - (roll - np.arctan(roll))))
        assert (
            tool.clearance(np.array([z]))[0] == pytest.approx(0, abs=1e-12)
            if not sign
            else tool.clearance(np.array([z]))[0] < -1e-5
        )
    # And the root circle is as deep as the rack.
    assert tool.clearance(gear.root_radius * 1j * np.exp([-1j * np.pi / 12]))[0] == pytest.approx(0, abs=1e-12)


def test_a_tools_polygons_are_the_tool():
    tool = problem("gear-root").tool
    for polygon, t in zip(tool.polygons(5, 0.01), np.linspace(*tool.span, 5)):
        off = tool.distance(polygon, np.full(len(polygon), t))
        assert np.abs(off).max() < 1e-12
        edge = np.roll(polygon, -1) - polygon
        assert (np.imag(np.conj(edge) * np.roll(edge, -1)) > -1e-9).all()  # convex, counterclockwise
    circle = problem("cam-profile").tool.polygons(2, 0.5)[0]
    assert len(circle) >= 2 * np.pi * 10 / 0.5


@pytest.mark.parametrize("method", ["law of gearing", "cut by booleans", "sampled distances"])
def test_conjugate_methods_find_the_whole_tooth_space(method):
    tooth, count = problem("conjugate-tooth"), np.nan if method == "law of gearing" else 160.0
    z = found("conjugate-tooth", method, count)
    turned, half = np.angle(z / -1j), np.pi / tooth.mate_teeth
    assert np.abs(turned).max() < half * (1 + 1e-9) and np.abs(turned).max() > 0.5 * half
    assert tooth.tip_radius - 0.1 < np.abs(z).max() <= tooth.tip_radius * (1 + 1e-12)
    # As deep as the tooth is high, or, sampled along radii, to a module below the pitch circle.
    low = tooth.mate_radius - (1.0 if method == "sampled distances" else 1.2) * tooth.module
    assert np.abs(z).min() == pytest.approx(tooth.mate_radius - tooth.module, abs=0.1) or np.abs(z).min() > low - 1e-3
    assert (turned > 0).all() if method == "sampled distances" else turned.min() < -0.5 * half


@pytest.mark.parametrize(
    ("method", "setting"),
    [("exact curves", np.nan), ("polylines trimmed", 80), ("cut by booleans", 80), ("arcs", 1e-3), ("one arc", np.nan)],
)
def test_root_methods_go_from_the_bottom_land_to_the_tip(method, setting):
    gear, z = problem("gear-root").gear(), found("gear-root", method, setting).vertices
    turned = np.angle(1j / z)
    assert turned.min() > 0 and turned.max() < np.pi / gear.teeth * (1 + 1e-9)
    assert np.abs(z[0]) == pytest.approx(gear.root_radius, abs=0.01) and abs(np.abs(z[-1]) - gear.tip_radius) < 0.5
    # Up the side, which turns back only where the cutter's corner has left the neck.
    assert (np.diff(np.abs(z)) > -1e-9).all() and len(z) > 8


def test_greedy_flattening_has_the_fewest_vertices():
    curve = problem("cam-flattening").curve()
    fewest = len(greedy(curve, 0.1))
    equal = len(gk.flatten(curve, 0.1))
    assert equal <= 1.03 * fewest + 4 and fewest <= equal + len(curve.breaks)
    assert len(by_halving(curve, 0.1)) > 1.2 * fewest and len(by_doubling(curve, 0.1)) > 1.5 * fewest


def test_linkages_by_hand_meet_their_precision_points():
    wanted = problem("function-synthesis")
    made = functions.by_hand(wanted, np.radians([[45.0, 30.0], [100.0, 60.0]]))
    s = 0.5 - 0.5 * np.cos((np.arange(3) + 0.5) * np.pi / 3)
    off = np.abs(functions.structural_error(wanted, made, s)).reshape(2, 2, 3)
    # The equations know nothing of the two ways to close: each point is met by one, and the second linkage stays on it.
    assert off.min(axis=0) == pytest.approx(0, abs=1e-12) and off[:, 1].max(axis=-1).min() < 1e-12


def test_structural_errors_are_those_of_the_moving_linkage():
    wanted, s = problem("function-synthesis"), np.linspace(0, 1, 7)
    sizes = np.array([0.6, 1.1, 0.9, 1.0, 2.0, -1.0])
    bar = gk.FourBar(100, 60, 110, 90)
    moved = gk.move(bar, 1.0 + wanted.swing * s, -1).rocker.direction
    off = np.angle(moved * np.exp(-1j * (2.0 + wanted.out * np.log2(1 + s))))
    assert functions.structural_error(wanted, sizes, s) == pytest.approx(off, abs=1e-12)


def test_path_errors_are_those_of_the_moving_linkage():
    path = problem("path-synthesis")
    (one, *_) = found("path-synthesis", "fits alone", 100)
    ground, crank, coupler, rocker = one.lengths.tolist()
    turned = float(np.degrees(np.angle(one.along)))
    bar = gk.FourBar(ground, crank, coupler, rocker, one.arm, origin=one.origin, ground_angle_deg=turned)
    drive = one.start + np.radians(20) * np.arange(18)
    at = gk.move(bar, drive, int(one.branch)).point("coupler_point").position
    rms = np.sqrt(np.mean(np.abs(at - path.points) ** 2))
    assert paths.coupler_path_error(path, [one, None]) == pytest.approx([rms, np.nan], abs=1e-12, nan_ok=True)


def test_drawings_are_read_as_another_reader_does(tmp_path):
    content = found("dxf-writing", "arcs", 0.01)
    (tmp_path / "gear.dxf").write_bytes(content)
    space = ezdxf.readfile(tmp_path / "gear.dxf").modelspace()
    (line,), (circle,) = space.query("LWPOLYLINE"), space.query("CIRCLE")
    rows = np.array(line.get_points("xyb"))
    ours = files.outline_in_file(content)
    assert np.abs(ours.vertices + complex(*circle.dxf.center.vec2) - rows[:, 0] - 1j * rows[:, 1]).max() < 1e-12
    assert np.array_equal(ours.bulges, rows[:, 2]) and ours.bulges.any()


def test_volumes_of_solids_and_areas_of_plates():
    square = np.array([0, 2, 2 + 3j, 3j])
    solid = files.bare_solid(square, np.array([[0, 1, 2], [0, 2, 3]]), [square], 5.0)
    assert files.stl_volume(solid) == pytest.approx(30, rel=1e-6) and len(solid) == 84 + 50 * 12
    assert problem("dxf-writing").area == pytest.approx(gk.area(gk.SpurGear(12, 2).outline) - np.pi * 2.5**2, rel=1e-7)


def test_a_bare_solid_s_normals_are_those_of_its_corners_and_look_out():
    square = np.array([0, 2, 2 + 3j, 3j])
    solid = files.bare_solid(square, np.array([[0, 1, 2], [0, 2, 3]]), [square], 5.0)
    read = np.frombuffer(
        solid, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")]), offset=84
    )
    out = read["corners"].mean(axis=1) - [1, 1.5, 2.5]
    assert np.linalg.norm(read["normal"], axis=1) == pytest.approx(1, abs=1e-6)
    assert ((read["normal"] * out).sum(axis=1) > 0.5).all()
    for edge in np.diff(read["corners"], axis=1).transpose(1, 0, 2):
        assert (read["normal"] * edge).sum(axis=1) == pytest.approx(0, abs=1e-6)


# What is measured as an error, of what is wrong by so much


def test_errors_of_a_file_are_those_of_its_worst_place():
    given = problem("csv-writing")
    lines = found("csv-writing", "all digits", np.nan).decode().splitlines()
    cells = lines[3].split(",")
    lines[3] = ",".join([*cells[:3], repr(float(cells[3]) - 20), cells[4]])
    errors = files.csv_error(given, "\n".join([*lines, ""]).encode())
    assert len(errors) == 5 * files.ROWS and errors.max() == pytest.approx(0.02) and (errors > 0).sum() == 1
    stl = FAMILIES["stl-writing"]
    solid = found("stl-writing", "chords", 1e-3)
    for size, off in ((1.01, 1.01**3 - 1), (0.99, 1 - 0.99**3)):
        read = np.frombuffer(
            solid, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")]), offset=84
        )
        grown = read.copy()
        grown["corners"] *= np.float32(size)
        (error,) = stl.error(problem("stl-writing"), solid[:84] + grown.tobytes())
        assert error == pytest.approx(off, abs=2e-5)
    drawing = found("dxf-writing", "chords", 1e-3)
    outline = files.outline_in_file(drawing)
    moved = [f"10\n{z.real:.9f}\n20\n{z.imag:.9f}\n" for z in 1.002 * outline.vertices]
    head = b"0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\nCUT\n10\n0\n20\n0\n40\n2.5\n0\nLWPOLYLINE\n8\nCUT\n70\n1\n"
    errors = files.dxf_error(problem("dxf-writing"), head + "".join(moved).encode() + b"0\nENDSEC\n0\nEOF\n")
    # Radially by 0.2 % of 10.75 to 14 mm; on flanks less of it shows.
    assert errors.max() == pytest.approx(0.002 * 14, rel=0.1) and errors.min() < 0.005
    assert len(errors) == 4 * len(outline.vertices)


def test_missing_results_are_nan():
    # Of so few points the polylines of root and flank miss each other.
    assert found("gear-root", "polylines trimmed", 8) is None
    assert np.isnan(FAMILIES["gear-root"].error(problem("gear-root"), None)).all()
    cut = problem("gear-root")
    line = found("gear-root", "exact curves", np.nan)
    lifted = replace(line, vertices=line.vertices * 1.001)
    errors = FAMILIES["gear-root"].error(cut, lifted)
    assert len(errors) == len(line.vertices) and errors.max() == pytest.approx(0.001 * cut.gear().root_radius)


# Weights


def test_weights_have_a_front_a_picture_and_columns_of_their_own():
    (one,) = CHART.families
    family = replace(one.family, weighed="vertices", weigh=lambda problem, found: 1.0)
    weights = (10.0, 1.0, 2.0, 3.0, 4.0, np.nan)
    heavy = gk.tradeoff.FamilyChart(family, tuple(replace(p, weight=w) for p, w in zip(one.points, weights)))
    # The fourth takes longer than one of less error, but weighs less.
    assert heavy.on_front.tolist() == [True, True, True, False, True, False]
    assert heavy.on_weight_front.tolist() == [True, True, True, True, True, False]
    made = chart_files(replace(CHART, families=(heavy,)))
    assert b"vertices per sum" in made["toy-sum-by-vertices.svg"] and b"time per sum" in made["toy-sum.svg"]
    rows = list(csv.DictReader(io.StringIO(made["chart.csv"].decode())))
    assert [row["weight"] for row in rows] == ["10", "1", "2", "3", "4", ""]
    assert not [name for name in chart_files(CHART) if "-by-" in name]
