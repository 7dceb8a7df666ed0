"""Teeth in mesh never overlap, touch where the marks say, and leave their play half on either side."""

import numpy as np
import pytest
import shapely
from shapely import affinity

import geomkin as gk
from geomkin import GearPair, RingGear, SpurGear
from geomkin.gear import GearRack, RackPair, gear_scene, pair_scene
from geomkin.gear.parts import GearStock, RingStock, gear_parts
from tests.campaign import by_default
from tests.gallery import FINE, frames, marks, named, point, recipe, seen

# mm. What chords leave of flanks that touch, and the area between them over some teeth, mm2.
NEAR, SLIVER = 2e-4, 2e-3


def both(pair):
    names, gears = pair.names, (pair.driver, pair.rack if isinstance(pair, RackPair) else pair.second)
    stocks = [RingStock() if gear.is_ring else GearStock() for gear in gears]
    parts = [gear_parts(gear, stock, name)[0] for gear, stock, name in zip(gears, stocks, names)]
    return pair_scene(pair, parts), names


PAIRS = {
    "tight": lambda: GearPair(SpurGear(17, 2), SpurGear(31, 2)),
    "with play": lambda: GearPair(
        SpurGear(20, 3, tooth_thickness_allowance=0.2), SpurGear(25, 3, tooth_thickness_allowance=0.1)
    ),
    "apart": lambda: GearPair(SpurGear(24, 2), SpurGear(36, 2), 60.4),
    "ring": lambda: GearPair(SpurGear(20, 2, tooth_thickness_allowance=0.1), RingGear(60, 2, addendum=0.8)),
    "rack, even": lambda: RackPair(SpurGear(14, 2.5, 0.2, tooth_thickness_allowance=0.1), GearRack(15, 2.5)),
    "rack, odd": lambda: RackPair(SpurGear(19, 2), GearRack(12, 2, tooth_thickness_allowance=0.1)),
}


@pytest.mark.parametrize("which", by_default(["with play", "ring", "rack, odd"], ["with play", "rack, odd"]))
def test_teeth_mesh_with_half_the_play_on_either_side(which):
    pair = PAIRS[which]()
    scene, names = both(pair)
    driver, other = (named(scene, name) for name in names)
    half = pair.backlash / 2
    for frame in frames(scene, 9):
        one, two = seen(driver, frame), seen(other, frame)
        assert one.intersection(two).area < SLIVER
        axis = other.origin[frame]
        for sense in (1, -1):
            # Moved by half of its play it touches, and moved a little more it digs in.
            moved = [_moved(two, sense * way, pair, axis) for way in (half, half + 0.05)]
            assert one.distance(moved[0]) < NEAR and one.intersection(moved[0]).area < SLIVER
            assert one.intersection(moved[1]).area > 10 * SLIVER


def _moved(polygon, way, pair, axis):
    if isinstance(pair, RackPair):
        return affinity.translate(polygon, way)
    return affinity.rotate(polygon, way / pair.working_radii[1], (axis.real, axis.imag), use_radians=True)


@pytest.mark.parametrize("which", ["apart", "ring", "rack, even"])
def test_contacts_lie_on_the_drivers_flanks_and_leave_half_the_play_to_the_other(which):
    pair = PAIRS[which]()
    scene, names = both(pair)
    play = pair.backlash / 2 * np.cos(np.arccos(pair.driver.base_radius / _working_radius(pair)))
    contacts, count = marks(scene, "point"), 0
    for frame in frames(scene):
        for mark in contacts:
            if np.isfinite(mark.place[frame]):
                z, count = point(mark.place[frame]), count + 1
                assert seen(named(scene, names[0]), frame).boundary.distance(z) < NEAR
                assert seen(named(scene, names[1]), frame).boundary.distance(z) == pytest.approx(play, abs=NEAR)
    reported = sum(np.isfinite(mark.place).astype(int) for mark in contacts)
    assert count and np.array_equal(reported, scene.table["pairs"])
    assert reported.mean() == pytest.approx(pair.contact_ratio, abs=0.05)


def _working_radius(pair):
    return pair.pinion.pitch_radius if isinstance(pair, RackPair) else pair.working_radii[0]


def test_one_pair_of_flanks_is_followed_from_its_first_contact_to_its_last():
    pair = GearPair(SpurGear(17, 2), SpurGear(31, 2))
    scene, _ = both(pair)
    along, known = scene.table["along"], np.isfinite(scene.table["along"])
    start, end = pair.contact_lengths
    assert along[0] == start and np.nanmax(along) == pytest.approx(end, abs=2 * pair.first.base_pitch / 60)
    assert np.all(np.diff(along[:-1][known[:-1]]) > 0)
    # The same turns as the table of one pair of flanks states.
    reported = gk.gear.contact_table(pair)
    inner = known & (np.arange(len(along)) < len(along) - 1)
    np.testing.assert_allclose(
        np.interp(along[inner], reported["along"], reported["first_turn"]), scene.table["first_turn"][inner], atol=1e-9
    )


GALLERY = {
    "gear-pair": [("first", "second")],
    "rack-and-pinion": [("pinion", "rack")],
    "planetary": [("sun", f"planet {k}") for k in (1, 2, 3)] + [(f"planet {k}", "ring") for k in (1, 2, 3)],
    "straight-sided-ring": [("gear", "ring")],
    "point-tooth": [("gear", "mate")],
}


@pytest.mark.parametrize("name", by_default(GALLERY, GALLERY.keys() - {"planetary", "point-tooth"}))
def test_teeth_of_the_gallery_never_overlap(name):
    scene = recipe(name).scene
    for frame in frames(scene, 3):
        for one, two in GALLERY[name]:
            first, second = seen(named(scene, one), frame), seen(named(scene, two), frame)
            assert first.intersection(second).area < 2 * SLIVER and first.distance(second) < 0.1


@pytest.mark.parametrize("name", ["straight-sided-ring", "point-tooth"])
def test_contacts_of_any_teeth_lie_on_the_mate(name):
    scene, own = recipe(name).scene, recipe(name)
    mate = named(scene, "ring" if own.design.is_ring else "mate")
    contacts = marks(scene, "point")
    for frame in frames(scene):
        touching = [mark.place[frame] for mark in contacts if np.isfinite(mark.place[frame])]
        assert touching
        assert max(seen(mate, frame).boundary.distance(point(z)) for z in touching) < 2e-3


@pytest.mark.parametrize(
    "gear",
    [
        lambda: SpurGear(8, 4),
        lambda: SpurGear(17, 2, 0.4, tooth_thickness_allowance=0.1),
        pytest.param(lambda: RingGear(48, 2, addendum=0.8), marks=pytest.mark.campaign),
    ],
)
def test_the_tool_cuts_the_gear_and_nothing_more(gear):
    gear = gear()
    stock = RingStock() if gear.is_ring else GearStock()
    scene = gear_scene(gear, gear_parts(gear, stock))
    (edge,) = (curve.curve for curve in scene.curves if curve.body == "tool")
    local, tool = gk.flatten(edge, FINE), named(scene, "tool")
    gap = []
    for frame in frames(scene, 7):
        z = tool.origin[frame] + tool.direction[frame] * local
        if not edge.closed:
            z = np.append(z, [z[-1] + 10j * gear.module, z[0] + 10j * gear.module])
        cutter, wheel = shapely.Polygon(np.column_stack([z.real, z.imag])), seen(named(scene, "gear"), frame)
        assert cutter.intersection(wheel).area < SLIVER
        gap.append(cutter.distance(wheel))
        # Where it is said to cut, both are; and there the tooth is as thick as the plate is.
        for mark in marks(scene, "point"):
            if np.isfinite(mark.place[frame]) and not gear.tooth_thickness_allowance:
                assert max(cutter.distance(point(mark.place[frame])), wheel.distance(point(mark.place[frame]))) < NEAR
        radius = scene.table["radius"][frame]
        if np.isfinite(radius):
            ring = shapely.Point(0, 0).buffer(radius, 4096).exterior
            across = ring.intersection(wheel).length / gear.teeth
            assert across == pytest.approx(scene.table["thickness"][frame], abs=8e-3)
    assert max(gap) < NEAR and len(marks(scene, "point")) > 0
