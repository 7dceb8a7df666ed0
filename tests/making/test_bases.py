"""Base plates: holes in the written drawing against distances found another way, and guides against the motion."""

import math
import re

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk

PAIR = """
kind = "gear-pair"
first = { teeth = 12, module = 3, profile_shift = 0.6, addendum = 0.8733 }
second = { teeth = 24, module = 3, profile_shift = 0.36, addendum = 0.8733 }
first_stock = { bore = 8 }
second_stock = { bore = 10 }
"""
RACK = """
kind = "rack-and-pinion"
pinion = { teeth = 14, module = 2.5, profile_shift = 0.2 }
rack = { teeth = 15, module = 2.5 }
stock = { bore = 8 }
"""
PLANETARY = """
kind = "planetary"
drive = { step_deg = 30 }
sun_stock = { bore = 8 }
planet_stock = { bore = 7 }
ring_stock = { rim = 12 }
[gears]
planets = 3
sun = { teeth = 24, module = 2 }
planet = { teeth = 18, module = 2 }
ring = { teeth = 60, module = 2, addendum = 0.8 }
"""
CAM = """
kind = "disk-cam"
drive = {{ step_deg = 5 }}
stock = {{ bore = 10, clearance = 0.1 }}
[cam]
base_radius = {radius}
direction = "clockwise"
follower = {{ {follower} }}
program = [
    {{ kind = "dwell", end_deg = 60 }},
    {{ kind = "rise", law = "cycloidal", rise{deg} = {lift}, end_deg = 180 }},
    {{ kind = "return", law = "harmonic", end_deg = 360 }},
]
"""
FOLLOWERS = {
    "roller": ('kind = "translating-roller", roller_radius = 10, offset = 5', "", 40, 20),
    "undercut": ('kind = "translating-roller", roller_radius = 24', "", 20, 20),
    "knife edge": ('kind = "translating-roller", roller_radius = 0', "", 40, 20),
    "flat": ('kind = "translating-flat"', "", 35, 8),
    "tilted": ('kind = "translating-flat", tilt_deg = 12', "", 35, 8),
    "arm": ('kind = "oscillating-roller", roller_radius = 8, pivot_distance = 95, arm_length = 75', "_deg", 40, 18),
    "large roller": (
        'kind = "oscillating-roller", roller_radius = 45, pivot_distance = 95, arm_length = 75',
        "_deg",
        20,
        9,
    ),
    "flat arm": ('kind = "oscillating-flat", pivot_distance = 80, face_offset = 6', "_deg", 30, 12),
}


def cam(name, more="[base]\n"):
    follower, deg, radius, lift = FOLLOWERS[name]
    return gk.load(CAM.format(follower=follower, deg=deg, radius=radius, lift=lift) + more)


def part(recipe, name):
    return next(p for p in recipe.parts if p.name == name)


def polygon(curve):
    z = gk.flatten(curve, 1e-4)
    return shapely.Polygon(np.column_stack([z.real, z.imag]))


@pytest.fixture
def written(tmp_path):
    """Diameter -> places of the round holes in the drawing of a recipe as it is written."""

    def read(recipe):
        gk.write(recipe, tmp_path / "parts.dxf")
        found = {}
        for circle in ezdxf.readfile(tmp_path / "parts.dxf").modelspace().query("CIRCLE[layer=='HOLE']"):
            place = complex(circle.dxf.center.x, circle.dxf.center.y)
            found.setdefault(round(2 * circle.dxf.radius, 4), []).append(place)
        return found

    return read


def moving(recipe):
    """(body, its frame's origin and direction) of all bodies but the ground, frame by frame."""
    for body in recipe.scene.bodies:
        if body.name != "ground":
            yield body, np.broadcast_to(body.origin, recipe.scene.assembled.shape), body.direction


def test_shafts_in_the_drawing_stand_at_the_working_distance_of_the_involute_equation(written):
    holes = written(gk.load(PAIR + "[base]\n"))
    # inv(a_w) = inv(a) + 2 (x1 + x2) / (z1 + z2) tan(a), by halves.
    a = math.radians(20)
    wanted = math.tan(a) - a + 2 * (0.6 + 0.36) / (12 + 24) * math.tan(a)
    low, high = a, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if math.tan(middle) - middle < wanted else (low, middle)
    distance = 3 * (12 + 24) / 2 * math.cos(a) / math.cos(low)
    ((one,), (two,)) = holes[8.2], holes[10.2]
    assert abs(two - one) == pytest.approx(distance, abs=1e-3) and distance == pytest.approx(56.4999, abs=1e-4)
    assert len(holes[4.2]) == 4


@pytest.mark.parametrize("text", [PAIR, PLANETARY, RACK])
def test_screws_stand_clear_of_all_that_moves(text):
    _clear(gk.load(text + "[base]\nscrew = 5\n"), 5)


@pytest.mark.parametrize("name", ["undercut", "tilted", "arm"])
def test_screws_stand_clear_of_cam_and_follower(name):
    _clear(cam(name), 4)


def _clear(recipe, screw):
    """Heads twice as wide as the screws stay off all moving parts at all frames, and off the base's edge."""
    base = part(recipe, "base")
    ground = next(body for body in recipe.scene.bodies if body.name == "ground")
    heads = [shapely.Point(h.centre.real, h.centre.imag).buffer(screw) for h in base.holes[-4:]]
    plate = polygon(base.outline)
    assert all(plate.contains(head) for head in heads)
    frames = range(0, len(recipe.scene.time), max(1, len(recipe.scene.time) // 16))
    turned = np.conj(ground.direction[0])
    for body, origin, direction in moving(recipe):
        for one in body.parts:
            z = gk.flatten(one.outline, 0.01)
            for k in frames:
                placed = (origin[k] + direction[k] * z) * turned
                loop = shapely.Polygon(np.column_stack([placed.real, placed.imag]))
                # The ends of a rack go past the base.
                assert body.name == "rack" or plate.contains(loop)
                assert not any(loop.intersects(head) for head in heads), (body.name, k)


def _boxes(recipe, screw):
    """Corners of what the base's screws leave, and of all that moves at any frame, as seen from the base."""
    base = part(recipe, "base")
    ground = next(body for body in recipe.scene.bodies if body.name == "ground")
    screws = np.array([hole.centre for hole in base.holes[-4:]])
    moved = []
    for body, origin, direction in moving(recipe):
        for one in body.parts:
            z = gk.flatten(one.outline, 0.01)
            moved.append((np.broadcast_to(origin, direction.shape)[:, None] + direction[:, None] * z).ravel())
    places = np.concatenate(moved) * np.conj(ground.direction[0])
    inner = [screws.real.min() + screw, screws.real.max() - screw, screws.imag.min() + screw, screws.imag.max() - screw]
    return inner, [places.real.min(), places.real.max(), places.imag.min(), places.imag.max()]


@pytest.mark.parametrize("name", ["roller", "flat arm"])
def test_a_base_is_as_large_as_cam_and_follower_reach_and_no_larger(name):
    inner, reach = _boxes(cam(name), 4.0)
    assert inner == pytest.approx(reach, abs=0.12)


@pytest.mark.parametrize("text", [PAIR, PLANETARY])
def test_a_base_is_as_large_as_gears_reach_and_no_larger(text):
    inner, reach = _boxes(gk.load(text + "[base]\nscrew = 5\n"), 5.0)
    # Between frames a tip goes on by no more than its own rise over them.
    assert inner == pytest.approx(reach, abs=0.4)


@pytest.mark.parametrize("name", ["undercut", "knife edge", "tilted"])
def test_the_slot_holds_the_pins_of_a_stem_over_the_whole_turn(name):
    recipe = cam(name)
    _guided(recipe, "follower", 6.0, part(recipe, "follower").holes[-2:], exact=name != "undercut")


def _guided(recipe, name, diameter, holes, exact):
    """No pin meets the slot's walls at any frame, and none has more play across it than the clearance.

    exact: the pins come to both ends of the slot, too.
    """
    slot = polygon(part(recipe, "base").holes[1])
    body, origin, direction = next(row for row in moving(recipe) if row[0].name == name)
    centres = np.concatenate([origin + direction * hole.centre for hole in holes])
    pins = shapely.buffer(shapely.points(centres.real, centres.imag), diameter / 2, quad_segs=64)
    assert shapely.contains(slot, pins).all()
    nearest = shapely.distance(slot.exterior, pins)
    assert nearest.max() == pytest.approx(0.1, abs=2e-3)
    ends = [polygon(hole).centroid for hole in holes]
    assert len(ends) == 2 and body.parts
    low, high = slot.bounds[:2], slot.bounds[2:]
    reach = shapely.union_all(pins).bounds
    if exact:
        assert reach == pytest.approx((low[0] + 0.1, low[1] + 0.1, high[0] - 0.1, high[1] - 0.1), abs=2e-3)


def test_a_rack_goes_as_far_as_its_outer_teeth_and_runs_at_the_height_of_its_mesh():
    recipe = gk.load(RACK + "[base]\n")
    pair, rack, base = recipe.design, part(recipe, "rack"), part(recipe, "base")
    slot, (left, right) = polygon(base.holes[1]), (hole.centre for hole in rack.holes)
    # From the outline: the teeth's tips, of which the outer ones come to stand under the pinion's axis.
    z = gk.flatten(rack.outline, 1e-4)
    tips = np.sort(z.real[np.isclose(z.imag, z.imag.max(), atol=1e-6)])
    first, last = (tips[0] + tips[1]) / 2, (tips[-1] + tips[-2]) / 2
    across = 4.2
    assert slot.bounds[0] == pytest.approx(left.real - last - across / 2, abs=1e-3)
    assert slot.bounds[2] == pytest.approx(right.real - first + across / 2, abs=1e-3)
    middle = (slot.bounds[1] + slot.bounds[3]) / 2 - left.imag
    pinion, bar = gk.flatten(part(recipe, "pinion").outline, 1e-4), z
    poses = pair.poses(0.3)
    turned = complex(poses[0].direction) * pinion
    for up, meets in ((0.0, False), (0.35, True)):
        placed = bar + poses[1].origin.real + 1j * (middle + up)
        shapes = [shapely.Polygon(np.column_stack([w.real, w.imag])) for w in (turned, placed)]
        assert (shapes[0].intersection(shapes[1]).area > 1e-3) == meets
    # It is guided where it must be: nearer to the pinion by less than the backlash is play, farther lets go.
    assert middle == pytest.approx(-pair.distance, abs=1e-6)


def test_the_screws_of_a_ring_go_through_ring_and_base_as_it_meshes(written):
    recipe = gk.load(PLANETARY + "[base]\n")
    ring, base = part(recipe, "ring"), part(recipe, "base")
    body, origin, direction = next(row for row in moving(recipe) if row[0].name == "ring")
    over = np.array([origin[0] + direction[0] * hole.centre for hole in ring.holes[1:]])
    under = np.array([hole.centre for hole in base.holes[1:7]])
    assert np.abs(over[:, None] - under).min(axis=0) == pytest.approx(np.zeros(6), abs=1e-9)
    assert body.fixed and (direction == direction[0]).all() and base.hole_names[:7] == ("A", *"BBBBBB")
    # As written: six on each of the two parts, evenly, in the middle of the rim, and the four of the corners.
    holes = written(recipe)
    assert len(holes[4.2]) == 16 and len(holes[8.2]) == 1
    (middle,) = holes[8.2]
    around = sorted(round(abs(z - middle), 3) for z in holes[4.2])
    outer = float(np.abs(gk.flatten(ring.outline, 1e-4)).max())
    assert sum(r == pytest.approx(outer - 6, abs=2e-3) for r in around) >= 6
    z = np.sort(np.angle(under))
    assert np.diff(z) == pytest.approx(np.full(5, np.pi / 3))
    # They leave the planets' room alone.
    teeth = polygon(ring.holes[0])
    assert all(teeth.disjoint(polygon(hole)) for hole in ring.holes[1:])


def test_what_no_base_can_hold_is_refused_with_its_key(tmp_path):
    for text, field, words in [
        (PAIR.replace("bore = 8", "bore = 0") + "[base]\n", "first_stock.bore", "at least 0.01"),
        (PAIR + "[base]\nclearance = 60\n", "base.clearance", "meet"),
        (PAIR + "[base]\nedge = 1e6\n", "base", "100000 mm"),
        (RACK.replace("teeth = 15", "teeth = 3") + "[base]\n", "rack.teeth", "at least 4"),
        (RACK + "[base]\nguide_pin = 9.3\n", "base.clearance", "less than 0.075 mm"),
        (RACK + "[base]\nguide_pin = 12\n", "base.guide_pin", "less than 9.175 mm"),
        (PLANETARY + "[base]\nscrew = 0\n", "base.screw", "give their diameter"),
        (PLANETARY.replace("rim = 12", "rim = 3") + "[base]\n", "base.screw", "less than 2.8 mm"),
        (PLANETARY.replace("bore = 8", "bore = 0") + "[base]\n", "sun_stock.bore", "0.01 mm"),
    ]:
        with pytest.raises(gk.DesignError) as caught:
            gk.write(gk.load(text), tmp_path / "parts.dxf")
        assert caught.value.field == field and words in f"{caught.value.problem} {caught.value.remedy}"


def test_what_guides_no_follower_is_refused_with_its_key():
    for name, stock, field in [
        ("roller", "stem_length = 30", "stock.stem_length"),
        ("flat", "pivot_bore = 0", "stock.pivot_bore"),
        ("roller", "bore = 0", "stock.bore"),
        ("roller", "bar_width = 100, stem_length = 400", "stock.bar_width"),
    ]:
        follower, deg, radius, lift = FOLLOWERS[name]
        text = CAM.format(follower=follower, deg=deg, radius=radius, lift=lift)
        recipe = gk.load(text.replace("bore = 10, clearance = 0.1", stock) + "[base]\n")
        with pytest.raises(gk.DesignError) as caught:
            _ = recipe.parts
        assert caught.value.field == field and caught.value.remedy


def test_a_stem_as_long_as_the_refusal_says_is_guided():
    follower, deg, radius, lift = FOLLOWERS["tilted"]
    text = CAM.format(follower=follower, deg=deg, radius=radius, lift=lift) + "[base]\n"
    with pytest.raises(gk.DesignError, match="stem_length") as caught:
        _ = gk.load(text.replace("bore = 10", "bore = 10, stem_length = 30")).parts
    least = re.search(r"at least (\S+) mm", caught.value.remedy)[1]
    assert gk.load(text.replace("bore = 10", f"bore = 10, stem_length = {least}")).parts
