"""The thinnest wall of a part, against dense samples of its exact curves, known necks and whole recipes."""

from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.gear.parts import Web, openings
from geomkin.making.bores import keyed_bore
from geomkin.model.machinability import thinnest_wall
from geomkin.plane.vec import Pose
from tests.campaign import by_default

LIMIT = 1.5
PLATE = gk.plane.Polyline(np.array([0, 100, 100 + 60j, 60j]))
HULL = gk.plane.rounded_hull([0, 90, 40 + 45j], 12)


def part(outline, *holes, thickness=3.0):
    return gk.Part("plate", outline, holes, thickness)


def sampled(curves):
    """Least distance between samples of different curves, and how far from the exact one it may be."""
    z = [c.point(np.linspace(c.breaks[:-1], c.breaks[1:], 1 + 1200 // (len(c.breaks) - 1)).T.ravel()) for c in curves]
    step = max(np.abs(np.diff(one)).max() for one in z)
    pairs = [(one, two) for k, one in enumerate(z) for two in z[:k]]
    return min(np.abs(one[:, None] - two).min() for one, two in pairs), step


# Made when asked for: a fault in one of them is that case's.
CASES = {
    "hole near the middle of a long edge": lambda: (PLATE, gk.plane.Circle(50 + 3.2j, 3)),
    "hole in a corner arc": lambda: (HULL, gk.plane.Circle(95 - 4j, 4)),
    "two holes": lambda: (PLATE, gk.plane.Circle(30 + 30j, 8), gk.plane.Circle(45 + 31j, 6)),
    "three holes of which the far two are nearest": lambda: (
        PLATE,
        *(gk.plane.Circle(z + 30j, 4) for z in (20, 60, 69)),
    ),
    "round plate": lambda: (gk.plane.Circle(1j, 30), gk.plane.Circle(11 + 3j, 15)),
    "slot to edge": lambda: (HULL, gk.plane.slot(10, 70 - 5j, 3)),
    "slot to slot": lambda: (PLATE, gk.plane.slot(20 + 20j, 60 + 25j, 4), gk.plane.slot(30 + 40j, 80 + 33j, 3)),
    "slot in a circle": lambda: (gk.plane.Circle(0, 20), gk.plane.slot(-12, 12 + 3j, 4)),
    "gear and bore": lambda: (gk.SpurGear(17, 2).outline, gk.plane.Circle(0, 12)),
    "gear and keyed bore": lambda: (gk.SpurGear(17, 2).outline, *keyed_bore(20, 0, 6, 2, 1j, 60, "stock")),
    "gear with spokes": lambda: (
        gk.SpurGear(20, 4).outline,
        gk.plane.Circle(0, 6),
        *openings(Web(20, 3, count=3), 6, 35, "web"),
    ),
    "gear with holes": lambda: (gk.SpurGear(20, 4).outline, *openings(Web(40, 3, "holes", 4), 6, 35, "web")),
    "ring": lambda: (gk.plane.Circle(0, 45), gk.plane.Reversed(gk.SpurGear(20, 4).outline)),
    "cam": lambda: (gk.load("recipes/roller-cam.toml").cam.profile, gk.plane.Circle(20, 15)),
}


@pytest.mark.parametrize("name", CASES)
def test_thinnest_wall_is_the_least_distance_of_the_exact_curves(name):
    outline, *holes = curves = CASES[name]()
    wanted, step = sampled(curves)
    found = thinnest_wall(part(outline, *holes), LIMIT)
    # Samples are no nearer than the curves; half a step along both puts them off by less than this.
    # A thousandth of the limit, rounded to hundredths of a mm.
    tolerance = 1e-3 * LIMIT + 0.005
    assert wanted - step**2 / max(wanted, step) - tolerance <= found <= wanted + tolerance


@pytest.mark.parametrize(("scale", "turn"), [(1e-5, 0.0), (1e4, 1.0)])
def test_walls_grow_with_the_part_and_turn_with_it(scale, turn):
    pose = Pose(scale * (300 - 20j), np.exp(1j * turn))
    outline = gk.plane.Moved(gk.plane.rounded_hull(scale * np.array([0, 90, 40 + 45j]), 12 * scale), pose)
    hole = gk.plane.Moved(gk.plane.slot(10 * scale, (70 - 8j) * scale, 3 * scale), pose)
    # Sides of the slot's far end to the lower edge.
    assert thinnest_wall(part(outline, hole), LIMIT * scale) == pytest.approx(scale, rel=1e-3)


def hourglass(neck, radius=10.0):
    """Two blocks joined by a waist between two arcs of a radius that bulge inwards."""
    side, high = 20.0, neck / 2 + radius
    z = np.array([-radius - side - 1j * high, -radius - 1j * high, radius - 1j * high, radius + side - 1j * high])
    return gk.plane.Polyline(np.concatenate([z, -z]), np.array([0, -1, 0, 0, 0, -1, 0, 0.0]))


@pytest.mark.parametrize(("neck", "turn"), [(0.4, 0.0), (1.0, 0.3), (2.9, 2.0)])
def test_neck_of_an_outline(neck, turn):
    turned = gk.plane.Moved(hourglass(neck), Pose(5 - 3j, np.exp(1j * turn)))
    assert thinnest_wall(part(turned), LIMIT) == pytest.approx(neck, abs=5e-4)


def test_a_bar_with_parallel_sides_is_a_wall_and_a_tapered_one_is_none():
    bar = np.array([0, 50, 50 + 1j, 1j])
    assert thinnest_wall(part(gk.plane.Polyline(bar)), LIMIT) == 1.0
    assert thinnest_wall(part(gk.plane.Polyline(np.array([0, 50, 50 + 1j, 8j]))), LIMIT) == np.inf
    tine = gk.plane.Polyline(np.array([0, 40, 40 + 20j, 20 + 20j, 20 + 60j, 19.2 + 60j, 19.2 + 20j, 20j]))
    assert thinnest_wall(part(tine), LIMIT) == pytest.approx(0.8, abs=5e-4)


def test_a_tongue_within_one_opening_is_a_neck():
    """An opening that nearly closes on itself leaves its middle on a tongue 0.7 mm wide."""
    outer, inner, gap = 20.0, 14.0, 0.35
    a, b = (np.sqrt(r**2 - gap**2) + 1j * gap for r in (outer, inner))
    turn = [2 * np.pi - 2 * np.angle(a), 2 * np.pi - 2 * np.angle(b)]
    opening = gk.plane.Polyline(
        np.array([a, -a.conjugate(), -a, a.conjugate(), b.conjugate(), -b, -b.conjugate(), b]),
        np.tan(np.array([np.pi - 2 * np.angle(a), 2 * np.angle(a), np.pi - 2 * np.angle(a), 0] * 2) / 4)
        * np.array([1, 1, 1, 0, -1, -1, -1, 0]),
    )
    assert turn[0] > 6 and thinnest_wall(part(gk.plane.Circle(0, 30), opening), LIMIT) == pytest.approx(0.7, abs=5e-4)


def test_waist_of_an_undercut_tooth():
    """Against the least width of the tooth on +y, level by level."""
    gear = gk.SpurGear(6, 2)
    z = gear.outline.point(np.linspace(gear.outline.breaks[0], gear.outline.breaks[-1], 200_001))
    side = z[(z.real > 0) & (z.real < 2) & (z.imag > gear.root_radius) & (z.imag < gear.pitch_radius)]
    waist = side[side.real.argmin()]
    assert gear.root_radius + 0.5 < waist.imag < gear.pitch_radius - 0.5
    assert thinnest_wall(part(gear.outline), 2.0) == pytest.approx(2 * waist.real, abs=1e-3)


YOKE = """
kind = "linkage"
linkage.driver = "crank"
linkage.bodies.ground = { a = [0, 0], d = [100, 0] }
linkage.bodies.crank = { a = [0, 0], b = [30, 0] }
linkage.bodies.coupler = { b = [0, 0], c = [90, 0], spare = [94.3, 0] }
linkage.bodies.rocker = { d = [0, 0], c = [70, 0] }
"""
FOUR_BAR = """
kind = "four-bar"
linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }
stock = { bar_width = 4.3 }
"""
CAM = """
kind = "disk-cam"
cam.follower = { kind = "translating-roller", roller_radius = 10 }
cam.base_radius = 40
cam.program = [{ kind = "rise", law = "cycloidal", rise = 10, end_deg = 180 }, { kind = "return", law = "cycloidal", end_deg = 360 }]
stock = { bore = 79.9 }
"""
WEB = """
kind = "spur-gear"
gear = { teeth = 40, module = 2 }
stock = { bore = 10, web = { hub = 10.1, rim = 4 } }
"""


@pytest.mark.parametrize(
    ("text", "names", "wall"),
    [
        (FOUR_BAR, {"ground", "crank", "coupler", "rocker", "spacer"}, 0.05),
        (YOKE, {"coupler"}, 0.1),
        (CAM, {"cam"}, 0.05),
        (WEB, {"gear"}, 0.05),
    ],
    ids=["hole near an edge", "two holes", "bore of a cam", "opening near a bore"],
)
def test_breaking_wall_fails_a_check(tmp_path, text, names, wall):
    (tmp_path / "thin.toml").write_text(text)
    walls = [c for c in check_recipe(tmp_path / "thin.toml").checks if c.name.startswith("thinnest wall")]
    failed = {c.name.removeprefix("thinnest wall of the "): c for c in walls if not c.passed}
    assert set(failed) == names
    assert all(c.value == pytest.approx(wall, abs=1e-3) and c.advice for c in failed.values())


@pytest.mark.parametrize(
    ("text", "names", "key"),
    [(FOUR_BAR, {"ground", "crank"}, "stock.bar_width"), (CAM, {"cam"}, "stock.bore"), (WEB, {"gear"}, "stock.bore")],
    ids=["links", "cam", "gear"],
)
def test_advice_names_keys_of_the_recipe_that_make_the_wall_thicker(text, names, key):
    recipe = gk.load(text)
    advised = {c.id: c.advice for c in recipe.checks if c.id.removeprefix("wall_") in names}
    assert len(advised) == len(names) and all(key in advice for advice in advised.values())
    change = -0.5 if key.endswith("bore") else 0.5
    table, name = key.split(".")
    stock = getattr(recipe, table)
    other = replace(recipe, **{table: replace(stock, **{name: getattr(stock, name) + change})})
    assert all(other.walls[name] > recipe.walls[name] + 0.2 for name in names)


def test_advice_on_a_part_of_a_machine_names_its_mechanism():
    machine = gk.load("recipes/geared-legs.toml")
    (legs, *_) = [name for name in machine.recipes if name != "pair"]
    ground = next(part for part in machine.parts if part.name == f"{legs}_ground")
    own = machine.recipes[legs].wall_advice(replace(ground, name="ground"))
    assert machine.wall_advice(ground) == f"{legs}: {own}" and "stock." in own


def plate_in_file(one, path):
    """A part as the file that is cut has it, to a thousandth of a mm."""
    gk.write(replace(one, count=1), path / "one.dxf", tolerance=1e-3)
    loops = {"CUT": [], "HOLE": []}
    for entity in ezdxf.readfile(path / "one.dxf").modelspace().query("LWPOLYLINE CIRCLE"):
        if entity.dxf.layer in loops:
            at = entity.flattening(1e-3) if entity.dxftype() == "CIRCLE" else entity.vertices_in_wcs()
            loops[entity.dxf.layer].append([(p.x, p.y) for p in at])
    ((outline,), holes) = loops.values()
    return shapely.Polygon(outline, holes)


def pieces_and_openings(plate, width):
    """What is left of a plate whose every edge is worn off by half a width."""
    left = plate.buffer(-width / 2, quad_segs=64)
    kept = [one for one in getattr(left, "geoms", [left]) if one.area > 1e-3]
    return len(kept), sum(len(one.interiors) for one in kept)


@pytest.mark.parametrize(
    "name",
    by_default(["whitworth", "planetary", "undercut-gear"], ["planetary", "undercut-gear"]),
)
def test_a_part_of_the_gallery_falls_apart_when_its_thinnest_wall_is_worn_off(name, tmp_path):
    """Openings run together or to the edge, or necks part, as soon as that much is worn off the file that is cut."""
    recipe = gk.load(f"recipes/{name}.toml")
    assert list(recipe.walls) == [one.name for one in recipe.parts]
    for one in recipe.parts:
        plate, wall = plate_in_file(one, tmp_path), recipe.walls[one.name]
        sound = (1, len(plate.interiors))
        assert pieces_and_openings(plate, wall - 0.01) == sound != pieces_and_openings(plate, wall + 0.01)


def turned(one, share):
    """The section of a twisted part at a share of its height, as a polygon: of its outline or its holes what moves."""
    loops = [gk.flatten(curve, 5e-3) for curve in (one.outline, *one.holes)]
    pose = one.twist.at(share)
    moves = [True] + [False] * len(one.holes) if one.twist.moves == "outline" else [False] + [True] * len(one.holes)
    placed = [pose.origin + pose.direction * z if move else z for z, move in zip(loops, moves)]
    return shapely.Polygon(gk.plane.xy(placed[0]), [gk.plane.xy(z) for z in placed[1:]])
