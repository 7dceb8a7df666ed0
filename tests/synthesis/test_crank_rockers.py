"""Crank-rockers of a swing and a crank's turn, judged by their simulated full turn and by brute force."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.rockers import families as design_checks


def full_turn(linkage, branch, frames=3600):
    """The rocker's swing, the crank's turn while it goes counterclockwise, and the least angle: fine steps, no formula.

    To about a step for the turn: places at which the rocker goes back.
    """
    drive = np.linspace(0, 2 * np.pi, frames + 1)
    motion = gk.move(linkage, drive, branch)
    assert motion.assembled.all()
    angle = np.unwrap(np.angle(motion.rocker.direction))
    rising = np.diff(angle) > 0
    # One stroke there and one back: two changes around the circle.
    assert np.sum(rising != np.roll(rising, 1)) == 2
    return np.degrees(np.ptp(angle)), 360 * np.mean(rising), np.degrees(motion.transmission_angle.min())


@pytest.mark.parametrize(
    ("swing", "turn", "published", "angle"),
    [
        (40, 160, (0.25683, 0.51964, 0.78517), 31.854),
        (60, 170, (0.30745, 0.75306, 0.62647), 37.371),
        (50, 200, (0.37011, 0.87082, 0.93374), 40.671),
    ],
)
def test_published_crank_rockers(swing, turn, published, angle):
    """Tables of the crank-rockers with the best least transmission angle, four to five digits; ground 1."""
    best = gk.crank_rocker(swing_deg=swing, crank_turn_deg=turn, ground=1.0, sense="same")
    lengths = best.linkage.crank, best.linkage.coupler, best.linkage.rocker
    # A search by hand leaves the lengths a little beside the top, where the angle hardly changes.
    assert lengths == pytest.approx(published, abs=1.5e-4)
    assert best.transmission_angle_deg == pytest.approx(angle, abs=1e-3)
    table = gk.FourBar(1, *published)
    assert best.transmission_angle_deg >= full_turn(table, 1)[2] - 5e-3


@pytest.mark.parametrize(("swing", "turn"), [(120, 190)])
def test_the_best_is_the_best_of_all_that_can_be_built_by_hand(swing, turn):
    """The dead centres are drawn: rocker pins on a unit circle, crank pivots on the arc that sees them, all measured."""
    best = gk.crank_rocker(swing, turn)
    outer, inner = 1.0, np.exp(1j * np.radians(swing))
    # From the pivot the directions to the two pins differ by the turn less half a turn: points of two circles.
    seen = np.radians(turn - 180)
    centre = 0.5 * (outer + inner) + 0.5j * (inner - outer) / np.tan(seen)
    pivot = centre + abs(outer - centre) * np.exp(1j * np.linspace(0, 2 * np.pi, 8001))
    reach, fold = abs(outer - pivot), abs(inner - pivot)
    sizes = np.array([abs(pivot), 0.5 * abs(reach - fold), 0.5 * (reach + fold), np.ones(len(pivot))])
    sizes = sizes[:, sizes.min(axis=0) > 1e-3] / sizes[0, sizes.min(axis=0) > 1e-3]
    drive = np.linspace(0, 2 * np.pi, 361)
    top = 0.0
    for part in np.array_split(sizes, 8, axis=1):
        motion = gk.move(gk.FourBar(*part), drive)
        angle = np.unwrap(np.angle(np.where(motion.assembled, motion.rocker.direction, 1)), axis=0)
        rising = np.mean(np.diff(angle, axis=0) > 0, axis=0)
        fits = motion.assembled.all(axis=0) & (abs(np.ptp(angle, axis=0) - np.radians(swing)) < 3e-4)
        fits &= abs(360 * rising - turn) < 2.1
        angles = np.where(fits, motion.transmission_angle.min(axis=0), 0)
        top = max(top, np.degrees(angles.max()))
    assert best.transmission_angle_deg - 1e-3 < top < best.transmission_angle_deg + 1e-6


def random_wishes(count, seed):
    rng = np.random.default_rng(seed)
    for number in range(count):
        swing, sense = float(rng.uniform(1, 175)), ("same", "opposite")[number % 2]
        half = 0.5 * swing if sense == "same" else -0.5 * swing
        yield swing, float(rng.uniform(91 + half, 269 + half)), sense


def obeys(swing, turn, sense, found, frames=3600):
    measured, counterclockwise, least = full_turn(found.linkage, found.branch, frames)
    assert found.defects == ()
    assert measured == pytest.approx(swing, abs=0.02) and measured <= swing + 1e-9
    # The crank turns counterclockwise: in the same sense is while the rocker does, too.
    assert (counterclockwise if sense == "same" else 360 - counterclockwise) == pytest.approx(turn, abs=1200 / frames)
    assert least == pytest.approx(found.transmission_angle_deg, abs=1e-9)
    assert gk.linkage.grashof_type(found.linkage) == "crank-rocker"
    assert found.swing_deg == pytest.approx(swing, abs=1e-8) and found.crank_turn_deg == pytest.approx(turn, abs=1e-4)
    ends = gk.move(found.linkage, found.drive, found.branch).rocker
    assert np.abs(ends.first) == pytest.approx(0, abs=1e-6)
    turned = np.degrees(np.angle(ends.direction[1] / ends.direction[0]))
    assert turned == pytest.approx(swing if sense == "same" else -swing, abs=1e-7)


def test_random_wishes_are_met():
    for swing, turn, sense in random_wishes(30, 1):
        obeys(swing, turn, sense, gk.crank_rocker(swing, turn, sense=sense))


@pytest.mark.campaign
def test_thousands_of_random_wishes_are_met_by_the_best_and_by_another():
    rng = np.random.default_rng(2)
    for swing, turn, sense in random_wishes(1500, 3):
        best = gk.crank_rocker(swing, turn, sense=sense)
        obeys(swing, turn, sense, best)
        low, high = best.family.range_deg
        free = low + (high - low) * rng.uniform(0.05, 0.95)
        other = gk.crank_rocker(swing, turn, sense=sense, free_angle_deg=free)
        obeys(swing, turn, sense, other)
        assert other.transmission_angle_deg <= best.transmission_angle_deg + 1e-9 or best.at_largest_ratio


def test_a_known_crank_rocker_is_in_its_family():
    """Random lengths, measured by simulation, asked for again: the same linkage."""
    rng = np.random.default_rng(4)
    for _ in range(30):
        crank = rng.uniform(0.1, 0.5)
        coupler, rocker = rng.uniform(crank + 0.05, 1.5, 2)
        lengths = sorted([1, crank, coupler, rocker])
        if lengths[0] != crank or lengths[0] + lengths[3] > lengths[1] + lengths[2] - 0.01:
            continue
        known = gk.FourBar(1, crank, coupler, rocker)
        dead = gk.linkage.dead_centres(known, "rocker")
        angles = np.angle(gk.move(known, dead).rocker.direction)
        turn = np.degrees(dead[1] - dead[0]) if angles[1] > angles[0] else 360 - np.degrees(dead[1] - dead[0])
        free = float(np.degrees(np.arctan2(crank, coupler)))
        again = gk.crank_rocker(float(np.degrees(np.ptp(angles))), float(turn), free_angle_deg=free)
        assert list(again.lengths.values()) == pytest.approx([1, crank, coupler, rocker], abs=1e-9)


def test_the_senses_are_two_names_of_one_linkage():
    one, other = gk.crank_rocker(50, 200), gk.crank_rocker(50, 160, sense="opposite")
    assert one.linkage == other.linkage
    assert one.drive[1] == pytest.approx(other.drive[0]) and other.drive[1] == pytest.approx(one.drive[0] + 2 * np.pi)
    assert one.time_ratio == pytest.approx(200 / 160) and other.time_ratio == pytest.approx(160 / 200)
    assert gk.crank_rocker(50, 160).linkage != one.linkage


@pytest.mark.parametrize("name", ["ground", "crank", "coupler", "rocker"])
@pytest.mark.parametrize("length", [35.0])
def test_any_length_sets_the_size(name, length):
    found, unit = gk.crank_rocker(40, 160, **{name: length}), gk.crank_rocker(40, 160)
    assert found.lengths[name] == length
    scale = length / unit.lengths[name]
    assert list(found.lengths.values()) == pytest.approx([scale * size for size in unit.lengths.values()], rel=1e-12)
    assert found.transmission_angle_deg == pytest.approx(unit.transmission_angle_deg, abs=1e-9)


def test_at_a_time_ratio_of_one_the_ratio_of_lengths_has_a_limit_and_that_is_said():
    best = gk.crank_rocker(40, 180)
    assert best.at_largest_ratio and best.ratio == pytest.approx(6)
    few = gk.crank_rocker(40, 180, largest_ratio=4)
    assert few.at_largest_ratio and few.ratio == pytest.approx(4) and few.ratio <= 4 + 1e-9
    assert few.transmission_angle_deg < best.transmission_angle_deg < 90 - 20
    assert not gk.crank_rocker(40, 160).at_largest_ratio
    # A swing so small that all of its cranks are shorter than a hundredth.
    small = gk.crank_rocker(0.5, 180)
    assert small.defects == () and small.ratio > 100
    obeys(40, 180, "same", few)


def test_a_time_ratio_stands_for_the_crank_s_turn():
    found = gk.crank_rocker(50, time_ratio=1.25)
    assert found.linkage == gk.crank_rocker(50, 200).linkage and found.time_ratio == pytest.approx(1.25)
    assert gk.crank_rocker(50, time_ratio=1.0).linkage == gk.crank_rocker(50).linkage
    for wish in ({"time_ratio": 1.25, "crank_turn_deg": 200}, {"time_ratio": 9.0}):
        with pytest.raises(gk.DesignError) as caught:
            gk.crank_rocker(50, **wish)
        assert caught.value.field == "time_ratio"


def test_the_trap_is_refused_and_the_other_sense_is_named():
    """45 deg and 100 deg: a Grashof linkage that stands in both dead centres, on two circuits: its swing is 1.9 deg."""
    with pytest.raises(gk.DesignError) as caught:
        gk.crank_rocker(45, 100)
    assert caught.value.field == "crank_turn_deg"
    obeys(45, 100, "opposite", gk.crank_rocker(45, 100, sense="opposite"))
    # What the lengths of the closed form alone would give there.
    s, free = np.sin(np.radians(22.5)), np.radians(33)
    far = [np.hypot(np.cos(np.radians(h)) * np.cos(free), np.sin(np.radians(h)) * np.sin(free)) for h in (27.5, 50)]
    trap = gk.FourBar(far[0], s * np.sin(free), s * np.cos(free), far[1])
    assert gk.linkage.grashof_type(trap) == "crank-rocker"
    assert full_turn(trap, 1)[0] < 40


@pytest.mark.parametrize("sense", ["same", "opposite"])
@pytest.mark.parametrize("swing", [0.1, 90])
def test_the_ends_that_a_refusal_names_work_and_beyond_them_nothing_does(swing, sense):
    with pytest.raises(gk.DesignError) as caught:
        gk.crank_rocker(swing, 0, sense=sense)
    words = caught.value.remedy.split()
    for turn, out in ((float(words[1]), -0.1), (float(words[3]), 0.1)):
        assert gk.crank_rocker(swing, turn, sense=sense).defects == ()
        with pytest.raises(gk.DesignError):
            gk.crank_rocker(swing, turn + out, sense=sense)


@pytest.mark.parametrize(
    ("wish", "field"),
    [
        ({"swing_deg": 180}, "swing_deg"),
        ({"swing_deg": 40, "sense": "both"}, "sense"),
        ({"swing_deg": 40, "ground": 0}, "ground"),
        ({"swing_deg": 40, "ground": 3.0, "crank": 1.0}, "crank"),
        ({"swing_deg": 40, "largest_ratio": 2.9}, "largest_ratio"),
        ({"swing_deg": 40, "free_angle_deg": 45}, "free_angle_deg"),
        ({"swing_deg": 40, "crank_turn_deg": 160, "free_angle_deg": 5.8}, "free_angle_deg"),
        ({"swing_deg": 40, "crank": 1e9}, "crank"),
        ({"swing_deg": 40, "rocker": 1e-12}, "rocker"),
    ],
)
def test_invalid_requests_are_refused(wish, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.crank_rocker(**wish)
    assert caught.value.field == field and caught.value.remedy


@pytest.mark.parametrize(
    "linkage",
    [gk.FourBar(100, 80, 70, 90), gk.FourBar(30, 80, 70, 90), gk.SliderCrank(30, 20)],
    ids=["double rocker", "double crank", "short rod"],
)
def test_what_does_not_go_there_and_back_once_has_no_full_turn(linkage):
    reported = design_checks.full_turn(linkage)
    assert np.isnan([reported.extent, reported.start, reported.turn, reported.least]).all()
