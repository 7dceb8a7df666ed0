"""Gear plates: what is cut out of them, measured on polygons of their outlines."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.parts import GearStock, Web, base_plate, gear_parts, openings
from geomkin.gear.parts_assembly import carrier
from geomkin.plane import region


def polygon(curve):
    return gk.flatten(curve, 1e-4)


@pytest.mark.parametrize(("count", "width"), [(2, 2.0), (5, 4.0)])
def test_spokes_are_as_wide_as_asked_and_hub_and_rim_stay_whole(count, width):
    web = Web(hub=20, rim=3, count=count, spoke_width=width)
    cut = openings(web, 4, 40, "web")
    assert len(cut) == count
    loops = [polygon(c) for c in cut]
    for loop in loops:
        assert region.is_simple(loop)
        assert np.abs(loop).min() == pytest.approx(10, abs=2e-4) and np.abs(loop).max() == pytest.approx(37, abs=2e-4)
    # Along the spoke on +y, its neighbours keep half its width on either side, and no less anywhere.
    beside = [loop * 1j ** (-1) for loop in loops]
    near = np.concatenate([z[z.real > 0] for z in beside])
    assert np.abs(near.imag).min() == pytest.approx(width / 2, abs=1e-9)


@pytest.mark.parametrize("curve", [openings(Web(hub=20, rim=3), 4, 40, "web")[0]])
def test_corners_of_a_window_are_round_with_smooth_joints(curve):
    z, bulges = np.asarray(curve.vertices), np.asarray(curve.bulges)
    chord = np.angle(np.roll(z, -1) - z)
    leaving, arriving = chord - 2 * np.arctan(bulges), chord + 2 * np.arctan(bulges)
    turn = np.angle(np.exp(1j * (leaving - np.roll(arriving, 1))))
    assert np.abs(turn).max() < 1e-12


def test_holes_fill_the_room_between_hub_and_rim():
    cut = openings(Web(hub=20, rim=20, form="holes", count=6), 4, 40, "web")
    for hole in cut:
        assert abs(hole.centre) - hole.radius == pytest.approx(10) and abs(hole.centre) + hole.radius == pytest.approx(
            20
        )


def test_shafts_stand_at_the_centre_distance():
    part = base_plate("base", [0j, 56.5 + 0j], [8, 10], 10, 6)
    assert abs(part.holes[1].centre - part.holes[0].centre) == 56.5
    gears = gk.gear.PlanetarySet(gk.SpurGear(24, 2), gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8), 4)
    plate = carrier(gears, (8, 6), 6, 5)
    centres = np.array([h.centre for h in plate.holes])
    assert np.abs(centres[1:]) == pytest.approx(42) and centres[0] == 0
    assert region.apart_inside(polygon(plate.outline), [polygon(h) for h in plate.holes], 0).all()


def test_what_leaves_no_gear_is_refused_by_the_key_of_the_recipe():
    for stock, field in [
        (GearStock(bore=100), "stock.bore"),
        (GearStock(bore=10, keyway_width=3), "stock.keyway_depth"),
        (GearStock(bore=10, web=Web(hub=9, rim=3)), "stock.web.hub"),
        (GearStock(bore=10, web=Web(hub=20, rim=30)), "stock.web.rim"),
        (GearStock(bore=10, web=Web(hub=20, rim=3, spoke_width=20)), "stock.web.spoke_width"),
        (GearStock(bore=10, web=Web(hub=20, rim=3, form="holes", count=20)), "stock.web.count"),
    ]:
        with pytest.raises(gk.DesignError) as caught:
            gear_parts(gk.SpurGear(40, 2), stock)
        assert caught.value.field == field and caught.value.remedy
