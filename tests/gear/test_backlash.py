"""Backlash of conjugate mates by second roads: the thick cutter rolled, finished outlines turned till they overlap."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import conjugate
from geomkin.gear.conjugate.shaping_gears import FlankGear
from geomkin.plane import region
from geomkin.recipe import recipe_class
from geomkin.recipe.template import template
from tests.campaign import by_default

from .sweeping import inner_points, least_clearance
from .test_conjugate import off_straight_tooth

POINTS = (3.55 + 32.6j, 2.95 + 34.4j, 2.35 + 36j, 1.75 + 37.4j, 1.2 + 38.4j, 0.75 + 39j)
# mm. A tenth of what the play is set to, on either outline.
TOLERANCE = 1e-4


def straight(backlash, internal, clearance=0.2):
    gear = gk.gear.StraightSidedGear(40, 2, 25, 0.8, 1.2)
    cutter = gear.cutter(clearance, backlash)
    return gear, conjugate(cutter, 40, gear.pitch_radius, 64 if internal else 50, 1.6, internal)


def points(backlash, internal, clearance=0.5):
    gear = gk.gear.PointToothGear(24, 3, POINTS)
    return gear, conjugate(gear.cutter(clearance, backlash), 24, gear.pitch_radius, 32, 2.6, internal)


def lantern(backlash, internal, clearance=0.5):
    pinion = gk.gear.LanternPinion(12, 4, 5.5)
    cutter = pinion.cutter(clearance, backlash)
    return pinion, conjugate(cutter, 12, pinion.pitch_radius, 48, 8 if internal else 7, internal)


# Made by, backlash, internal.
CASES = [
    pytest.param(straight, 0.2, False, id="straight"),
    pytest.param(straight, 0.05, True, id="straight ring"),
    pytest.param(points, 0.15, False, id="points"),
    pytest.param(lantern, 0.3, False, id="lantern", marks=pytest.mark.campaign),
    pytest.param(lantern, 0.02, True, id="lantern ring", marks=pytest.mark.campaign),
]


@pytest.mark.parametrize("clearance", [0.4])
@pytest.mark.parametrize("internal", by_default([False, True], [True]))
def test_the_turned_straight_tooth_never_enters_its_mate_and_touches_it_everywhere(internal, clearance):
    gear, mate = straight(0.2, internal, clearance)
    turn = np.exp(0.5j * 0.2 / gear.pitch_radius)
    off = off_straight_tooth(gear, clearance)
    z = inner_points(mate.outline.piece)
    least = least_clearance(mate, z, lambda w: np.minimum(off(w * turn), off(w / turn)))
    assert least.min() > -1e-9 and np.abs(least).max() < 1e-9


@pytest.mark.parametrize("clearance", [0.5])
@pytest.mark.parametrize("internal", by_default([False, True], [False]))
def test_the_turned_pin_never_enters_its_wheel_and_touches_it_everywhere(internal, clearance):
    pinion, mate = lantern(0.3, internal, clearance)
    turn = 0.5 * 0.3 / pinion.pitch_radius

    def off_widened_slot(w):
        w = w * np.exp(-1j * np.clip(np.angle(w / 1j), -turn, turn))
        beyond = np.clip(w.imag - pinion.pitch_radius, 0, clearance)
        return np.abs(w - 1j * (pinion.pitch_radius + beyond)) - pinion.pin_diameter / 2

    least = least_clearance(mate, inner_points(mate.outline.piece), off_widened_slot)
    assert least.min() > -1e-9 and np.abs(least).max() < 1e-9


def bodies(gear):
    """The gear's outline, or the pins', as polygons."""
    return [gk.flatten(c, TOLERANCE) for c in getattr(gear, "circles", None) or (gear.outline,)]


@pytest.mark.parametrize(("made", "backlash", "internal"), CASES)
def test_the_play_of_the_finished_outlines_is_the_backlash_at_every_angle_and_shared(made, backlash, internal):
    """The mate is turned to both sides till it digs in: half the backlash each, however the gear stands."""
    gear, mate = made(backlash, internal)
    one, outline = bodies(gear), gk.flatten(mate.outline, TOLERANCE)
    assert region.is_simple(outline)
    whole = sum(gk.area(gk.plane.Polyline(polygon)) for polygon in one)
    ratio = mate.gear_teeth / mate.teeth * (1 if internal else -1)

    def common(angle, extra):
        body = mate.pose.origin + mate.pose.direction * outline * np.exp(1j * (ratio * angle + extra))
        both = sum(region.overlap([polygon * np.exp(1j * angle)], [body]) for polygon in one)
        return whole - both if internal else both

    for angle in np.array([0.3]) * 2 * np.pi / mate.gear_teeth:
        for side in (1, -1):
            free, stuck = 0.0, side * backlash / mate.pitch_radius
            assert common(angle, free) < 1e-6 < common(angle, stuck)
            while abs(stuck - free) * mate.pitch_radius > 1e-4:
                middle = 0.5 * (free + stuck)
                free, stuck = (middle, stuck) if common(angle, middle) < 1e-6 else (free, middle)
            assert abs(free) * mate.pitch_radius == pytest.approx(backlash / 2, abs=1e-3)


@pytest.mark.parametrize(
    "gear",
    [
        gk.gear.StraightSidedGear(40, 2, 25, 0.8, 1.2),
        gk.gear.LanternPinion(12, 4, 5.5),
        FlankGear(gk.plane.Segment(1.4 + 18.7j, 0.6 + 21j), 20, 20.0),
    ],
    ids=lambda gear: type(gear).__name__,
)
def test_a_cutter_whose_teeth_meet_is_refused_and_the_number_named_works(gear):
    with pytest.raises(gk.DesignError) as caught:
        gear.cutter(0.2, 9.0)
    assert caught.value.field == "backlash"
    most = float(caught.value.remedy.split("at most ")[1])
    assert gear.cutter(0.2, most).closed == isinstance(gear, gk.gear.LanternPinion) and gear.cutter(0.0, most)


@pytest.mark.parametrize("internal", [False, True])
@pytest.mark.parametrize("tooth_thickness_allowance", [0.0, 1.3])
def test_the_distance_named_where_teeth_jam_leaves_them_no_play(internal, tooth_thickness_allowance):
    """At round amounts of tooth_thickness_allowance as at others."""
    first = gk.SpurGear(20, 4, tooth_thickness_allowance=tooth_thickness_allowance / 2)
    ring = {"addendum": 0.7, "tooth_thickness_allowance": tooth_thickness_allowance / 2}
    second = (
        gk.RingGear(60, 4, **ring)
        if internal
        else gk.SpurGear(31, 4, tooth_thickness_allowance=tooth_thickness_allowance / 2)
    )
    with pytest.raises(gk.DesignError) as caught:
        gk.GearPair(first, second, 84.0 if internal else 98.0)
    named = float(caught.value.remedy.split("to " if internal else "at least ")[1].split(" ")[0])
    assert gk.GearPair(first, second, named).backlash == pytest.approx(0, abs=1e-4)
    assert gk.GearPair(first, second).backlash == pytest.approx(tooth_thickness_allowance, abs=1e-9)


@pytest.mark.parametrize(
    "kind", by_default(["straight-sided-gears", "point-tooth-gears", "lantern-gears"], ["point-tooth-gears"])
)
def test_teeth_of_other_forms_without_backlash_are_advised_an_amount_that_is_accepted(kind):
    recipe = gk.load(template(recipe_class(kind)))
    jams = replace(recipe, mate=replace(recipe.mate, backlash=0.0))
    (advice,) = jams.remarks
    amount = float(advice.split("about ")[1].split(" mm")[0])
    assert 0 < amount < 0.1 * recipe.design.pitch_radius
    loose = replace(recipe, mate=replace(recipe.mate, backlash=amount))
    assert not loose.remarks and all(check.passed for check in loose.checks)


def test_advice_names_each_of_several_meshes():
    recipe = gk.load(template(recipe_class("planetary")))
    first, second = recipe.remarks
    assert first.startswith("Sun and planet") and second.startswith("Planet and ring")


@pytest.mark.parametrize("allowance", [0.0, 0.08])
def test_the_advised_shifts_leave_the_backlash_of_the_allowances(allowance):
    table = {
        "kind": "gear-pair",
        "first": {"teeth": 20, "module": 2, "tooth_thickness_allowance": allowance},
        "second": {"teeth": 40, "module": 2, "tooth_thickness_allowance": allowance},
        "centre_distance": 60.5,
    }
    advice = gk.load(table).notes["pair"]["backlash_advice"]
    table["first"]["profile_shift"] = float(advice.rpartition(" ")[2])
    followed = gk.load(table)
    assert "backlash_advice" not in followed.notes["pair"]
    assert 0 <= followed.design.backlash - 2 * allowance < 0.01 + 0.02 * allowance
