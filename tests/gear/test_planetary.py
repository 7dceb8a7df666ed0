"""Planetary sets: outlines of all their gears laid over each other, ratios from rolling without slip."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane import region
from tests.made import Made


def shifted():
    sun, planet = gk.SpurGear(13, 2, 0.4), gk.SpurGear(19, 2, 0.2)
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.PlanetarySet(sun, planet, gk.RingGear(53, 2, addendum=0.7))
    shift = float(caught.value.remedy.removeprefix("give "))
    return gk.gear.PlanetarySet(sun, planet, gk.RingGear(53, 2, shift, addendum=0.7))


def sets(sun=24, planet=18, ring=60, planets=3, **more):
    return gk.gear.PlanetarySet(
        gk.SpurGear(sun, 2), gk.SpurGear(planet, 2), gk.RingGear(ring, 2, addendum=0.8, **more), planets
    )


SETS = Made(
    {
        "four": lambda: sets(planets=4),
        "three": sets,
        "odd": lambda: sets(25, 20, 65),
        "shifted": shifted,
        "thinned": lambda: sets(tooth_thickness_allowance=0.1),
    }
)


@pytest.fixture
def gears(request):
    return SETS[request.param]


@pytest.mark.parametrize("gears", SETS, indirect=True)
def test_all_teeth_mesh_without_overlap_while_the_sun_turns_and_the_ring_stands(gears):
    sun, planet, ring = (gk.flatten(g.outline, 1e-4) for g in (gears.sun, gears.planet, gears.ring))
    first = None
    for turn in (0.0, 0.05, 1.0, 4.4):
        place, planets, around = gears.poses(turn)
        first = around.direction if first is None else first
        # The ring stands still, but for whole teeth.
        assert (around.direction / first) ** gears.ring.teeth == pytest.approx(1, abs=1e-9)
        for pose in planets:
            z = pose.place(planet)
            assert region.overlap([place.place(sun)], [z]) < 2e-3
            about = z - z[0]
            area = 0.5 * np.imag(np.conj(about) * np.roll(about, -1)).sum()
            assert area - region.overlap([around.place(ring)], [z]) < 2e-3
        one, two = planets[0].place(planet), planets[1].place(planet)
        assert region.overlap([one], [two]) == 0
        assert abs(planets[0].origin) == pytest.approx(gears.inner.centre_distance)


@pytest.mark.parametrize(("driver", "fixed"), list(permutations(("sun", "carrier", "ring"), 2)))
def test_any_member_drives_and_any_other_one_is_held(driver, fixed):
    """Outlines in mesh, the held member at rest, and pitch circles that roll without slip on each other."""
    gears, turn, step = SETS["thinned"], 0.7, 1e-6
    outlines = [gk.flatten(g.outline, 1e-4) for g in (gears.sun, gears.planet, gears.ring)]
    sun, planets, ring = gears.poses(np.array([turn, turn + step]), driver, fixed)
    speeds = {
        name: float(np.angle(z[1] / z[0])) / step
        for name, z in {"sun": sun.direction, "ring": ring.direction, "carrier": planets[0].origin,
                        "planet": planets[0].direction}.items()
    }  # fmt: skip
    assert speeds[driver] == pytest.approx(1, abs=1e-8) and speeds[fixed] == pytest.approx(0, abs=1e-8)
    assert speeds == pytest.approx({name: float(v) for name, v in gears.turns(driver, fixed).items()}, abs=1e-8)
    centre = speeds["carrier"] * (24 + 18)
    assert centre - speeds["planet"] * 18 == pytest.approx(speeds["sun"] * 24, abs=1e-6)
    assert centre + speeds["planet"] * 18 == pytest.approx(speeds["ring"] * 60, abs=1e-6)
    for pose in planets:
        wheel, hole, z = (
            of.origin[0] + of.direction[0] * z
            for of, z in zip((sun, ring, pose), (outlines[0], outlines[2], outlines[1]))
        )
        about = z - z[0]
        area = 0.5 * np.imag(np.conj(about) * np.roll(about, -1)).sum()
        assert region.overlap([wheel], [z]) < 2e-3 and area - region.overlap([hole], [z]) < 2e-3


def test_a_driver_that_is_held_is_refused():
    with pytest.raises(gk.DesignError) as caught:
        SETS["three"].turns("ring", "ring")
    assert caught.value.field == "fixed"


@pytest.mark.parametrize("gears", ["four"], indirect=True)
def test_ratios_follow_from_rolling_without_slip(gears):
    """Speeds of the pitch points, with each member held in turn."""
    r_s, r_p, r_r = 24.0, 18.0, 60.0
    for held in ("sun", "ring", "carrier"):
        for driver in {"sun", "ring", "carrier"} - {held}:
            speeds = gears.speeds(**{held: 0.0, driver: 1.0})
            centre = speeds["carrier"] * (r_s + r_p)
            assert centre - speeds["planet"] * r_p == pytest.approx(speeds["sun"] * r_s)
            assert centre + speeds["planet"] * r_p == pytest.approx(speeds["ring"] * r_r)
            (driven,) = {"sun", "ring", "carrier"} - {held, driver}
            assert gears.ratios[f"{driver} to {driven}"] == pytest.approx(1 / speeds[driven])


@pytest.mark.parametrize(
    ("make", "field", "remedy"),
    [
        (lambda: sets(planets=5), "planets", "give 4"),
        (lambda: sets(planets=14), "planets", "give 6"),
        (
            lambda: gk.gear.PlanetarySet(
                gk.SpurGear(12, 2),
                gk.SpurGear(12, 2),
                gk.RingGear(36, 2, cutter=gk.gear.PinionCutter(12), addendum=0.5),
                6,
            ),
            "planets",
            "give 4",
        ),
        (lambda: sets(planet=16), "ring.profile_shift", "give the ring 56 teeth"),
        (lambda: sets(planets=0), "planets", "at least 1"),
    ],
)
def test_sets_that_cannot_be_put_together_are_refused_by_name(make, field, remedy):
    with pytest.raises(gk.DesignError) as caught:
        make()
    assert caught.value.field == field and remedy in caught.value.remedy


def test_the_number_of_planets_named_in_a_refusal_can_be_put_in_at_first_go():
    """Over many numbers of teeth and planets; evenly and clear of each other by the places of their axes and tips."""
    refused = 0
    for sun in (12, 17, 40):
        for planet in (12, 14, 19, 33):
            ring = gk.RingGear(sun + 2 * planet, 2, addendum=0.5, cutter=gk.gear.PinionCutter(12))
            gears = gk.gear.PlanetarySet(gk.SpurGear(sun, 2), gk.SpurGear(planet, 2), ring, 1)
            for planets in range(2, 101, 7 if sun > 20 else 3):
                try:
                    replace(gears, planets=planets)
                except gk.DesignError as error:
                    refused += 1
                    named = int(error.remedy.removeprefix("give ").split(",")[0])
                    apart = abs(np.exp(2j * np.pi / named) - 1) * (sun + planet)
                    assert named == 1 or apart > 2 * gears.planet.tip_radius
                    assert replace(gears, planets=named).planets == named
    assert refused > 100


@pytest.mark.parametrize(
    "held",
    [{}, {"sun": 1.0}, {"sun": 1.0, "ring": 0.0, "carrier": 2.0}, {"sun": 1.0, "planet": 0.0}, {"sun": 1, "x": 2}],
)
def test_speeds_follow_from_two_of_the_three_and_nothing_else(held):
    gears = gk.gear.PlanetarySet(gk.SpurGear(24, 2), gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
    with pytest.raises(gk.DesignError):
        gears.speeds(**held)
