"""A pinion in its ring as a recipe: outlines in mesh, contacts, forces, handles; and tips of full clearance."""

from fractions import Fraction

import numpy as np
import pytest

import geomkin as gk
from tests.gallery import frames, marks, named, point, recipe, seen
from tests.texts import parse

TEXT = (
    'kind = "internal-gear-pair"\n{}\n[pinion]\nteeth = 20\nmodule = 2\ntooth_thickness_allowance = 0.06\n{}\n'
    "[ring]\nteeth = 50\nmodule = 2\naddendum = 0.8\ntooth_thickness_allowance = 0.06\n{}\n"
)
# mm2 and mm: what chords leave of flanks that touch.
SLIVER, NEAR = 2e-3, 2e-4


def test_the_pinion_turns_inside_its_ring_by_the_ratio_and_touches_where_the_marks_are():
    given = recipe("internal-pair")
    scene, play = given.scene, given.design.backlash / 2
    pinion, ring = (named(scene, name) for name in ("pinion", "ring"))
    turned = [np.unwrap(np.angle(body.direction)) for body in (pinion, ring)]
    assert np.ptp(turned[0]) / np.ptp(turned[1]) == pytest.approx(50 / 20)
    contacts = marks(scene, "point")
    for frame in frames(scene, 5):
        one, two = seen(pinion, frame), seen(ring, frame)
        assert one.intersection(two).area < SLIVER
        places = [mark.place[frame] for mark in contacts if np.isfinite(mark.place[frame])]
        assert places
        for place in places:
            assert one.exterior.distance(point(place)) < NEAR
            assert two.distance(point(place)) < play


def test_a_larger_centre_distance_closes_the_play_of_an_internal_pair():
    pairs = [parse(TEXT.format(f"centre_distance = {a}", "", "")).design for a in (29.9, 30.0, 30.1)]
    assert np.all(np.diff([pair.backlash for pair in pairs]) < 0)
    with pytest.raises(gk.RecipeError) as caught:
        parse(TEXT.format("centre_distance = 30.3", "", ""))
    assert caught.value.problems[0].key == "centre_distance"


def test_torques_balance_the_tooth_force_at_both_pitch_circles():
    given = recipe("internal-pair")
    loaded, (inner, outer) = given.aspect("loads").meshes.strength, given.design.working_radii
    torques = given.notes["loads"]["torque_n_mm"]
    assert torques["pinion"] == pytest.approx(loaded.tangential_force * inner)
    assert torques["ring"] == pytest.approx(loaded.tangential_force * outer)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (("[pinion]", "[pinion]\nprofile_shift = 2\non_pointed_tip = 'cut'"), "ring.profile_shift"),
        (("module = 2\naddendum", "module = 3\naddendum"), "ring.module"),
        (("[pinion]", "[pinion]\nprofile_shift = 5"), "pinion.profile_shift"),
        (("teeth = 20", "teeth = 55"), "ring.teeth"),
    ],
    ids=["shift", "module", "pinion", "teeth"],
)
def test_errors_name_the_keys_of_pinion_and_ring(change, key):
    with pytest.raises(gk.RecipeError) as caught:
        parse(TEXT.format("", "", "").replace(*change))
    assert caught.value.problems[0].key == key


def test_helices_of_pinion_and_ring_have_one_hand():
    given = parse(
        TEXT.format("helix_angle_deg = 20", "", "[pinion_stock]\nthickness = 10\n[ring_stock]\nthickness = 10")
    )
    pinion, ring = given.parts
    assert pinion.twist.turn * given.design.first.pitch_radius == pytest.approx(
        ring.twist.turn * given.design.second.pitch_radius
    )


def test_a_machine_turns_the_ring_by_the_ratio():
    given = recipe("internal-pair")
    ring = given.rotating_bodies["ring"]
    assert ring.speed == Fraction(2, 5) and ring.axis == complex(0, -given.design.centre_distance)
    scene = given.scene_at(np.linspace(0, 0.4, 5))
    for frame in range(5):
        assert seen(named(scene, "pinion"), frame).intersection(seen(named(scene, "ring"), frame)).area < SLIVER


SHIFTED = 'kind = "gear-pair"\ntips = "full-clearance"\n{}[first]\nteeth = 12\nmodule = 3\nprofile_shift = 0.6\n{}[second]\nteeth = 24\nmodule = 3\nprofile_shift = 0.36\n{}'


def test_outlines_of_full_clearance_have_the_tips_of_their_gears():
    pair = parse(SHIFTED.format("", "", "")).design
    for gear in (pair.first, pair.second):
        assert np.abs(gk.flatten(gear.outline, 1e-4)).max() == pytest.approx(gear.tip_radius, abs=6e-4)
    assert pair.clearances == pytest.approx((0.75, 0.75))


@pytest.mark.parametrize(
    "more",
    [
        ("", "", ""),
        ("centre_distance = 56.6\n", "", ""),
        ("", "rack = { fillet_radius = 0.2 }\n", "rack = { fillet_radius = 0.1 }\n"),
        ("", "addendum = 0.6\n", "rack = { dedendum = 1.35, tip_radius = 0.2 }\n"),
        ("helix_angle_deg = 25\nsection = \"normal\"\n", "", ""),
    ],
    ids=["plain", "apart", "fillets", "short", "helical"],
)  # fmt: skip
def test_tips_of_full_clearance_clear_the_roots_by_that_of_their_tools(more):
    given, text = parse(SHIFTED.format(*more)), SHIFTED.format(*more).replace('tips = "full-clearance"\n', "")
    pair, before = given.design, parse(text).design
    ends = [gk.flatten(gear.outline, 1e-4) for gear in (pair.first, pair.second)]
    a = pair.centre_distance
    rooms = [a - np.abs(ends[1 - k]).max() - np.abs(ends[k]).min() for k in range(2)]
    for gear, room, tip, was in zip(
        (before.first, before.second), rooms, (pair.second, pair.first), (before.second, before.first)
    ):
        full = (gear.rack.dedendum - gear.rack.addendum) * gear.module
        # Tips that are short enough stay.
        assert room == pytest.approx(full, abs=1e-3) or (room > full and tip.tip_radius == was.tip_radius)
    assert a == before.centre_distance


def test_rings_get_their_full_clearance_too():
    pair = parse(TEXT.format('tips = "full-clearance"', "profile_shift = 0.5", "profile_shift = 0.7")).design
    pinion, ring = (np.abs(gk.flatten(gear.outline, 1e-4)) for gear in (pair.first, pair.second))
    assert ring.max() - pair.centre_distance - pinion.max() >= 0.25 * 2 - 1e-3
    assert ring.min() - pair.centre_distance - pinion.min() >= 0.25 * 2 - 1e-3


def test_shifts_that_leave_no_tips_are_refused_by_key():
    with pytest.raises(gk.RecipeError) as caught:
        parse(
            SHIFTED.format("", 'on_pointed_tip = "cut"\n', 'on_pointed_tip = "cut"')
            .replace("0.36", "3")
            .replace("0.6", "1")
        )
    assert caught.value.problems[0].key == "first.profile_shift"
