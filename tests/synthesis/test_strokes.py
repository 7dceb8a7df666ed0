"""Slider-cranks of a stroke and a crank's turn, judged by their simulated full turn and by brute force."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import slider_crank_stroke


def full_turn(linkage, frames=3600):
    """The stroke, the crank's turn while the slider goes towards +x, and the least angle: fine steps, no formula."""
    drive = np.linspace(0, 2 * np.pi, frames + 1)
    motion = gk.move(linkage, drive)
    assert motion.assembled.all()
    place = motion.slider.origin.position.real
    rising = np.diff(place) > 0
    assert np.sum(rising != np.roll(rising, 1)) == 2
    return np.ptp(place), 360 * np.mean(rising), np.degrees(motion.transmission_angle.min())


def obeys(stroke, turn, found, frames=3600):
    measured, outwards, least = full_turn(found.linkage, frames)
    assert found.defects == () and found.branch == 1
    assert measured == pytest.approx(stroke, rel=1e-4) and measured <= stroke * (1 + 1e-12)
    assert outwards == pytest.approx(turn, abs=1200 / frames)
    assert least == pytest.approx(found.transmission_angle_deg, abs=1e-6)
    assert found.stroke == pytest.approx(stroke, rel=1e-9) and found.crank_turn_deg == pytest.approx(turn, abs=1e-4)
    ends = gk.move(found.linkage, found.drive).slider.origin.position.real
    assert ends[1] - ends[0] == pytest.approx(stroke, rel=1e-9)


def test_random_wishes_are_met():
    rng = np.random.default_rng(1)
    for _ in range(30):
        stroke, turn = float(10 ** rng.uniform(-6, 6)), float(rng.uniform(91, 269))
        obeys(stroke, turn, slider_crank_stroke(stroke, turn))


@pytest.mark.campaign
def test_thousands_of_random_wishes_are_met_by_the_best_and_by_another():
    rng = np.random.default_rng(2)
    for _ in range(600):
        turn = float(rng.uniform(90.5, 269.5))
        best = slider_crank_stroke(100, turn)
        obeys(100, turn, best)
        low, high = best.family.range_deg
        other = slider_crank_stroke(100, turn, free_angle_deg=low + (high - low) * rng.uniform(0.05, 0.95))
        obeys(100, turn, other)
        assert other.transmission_angle_deg <= best.transmission_angle_deg + 1e-9 or best.at_largest_ratio


@pytest.mark.parametrize("turn", [110, 200])
def test_the_best_is_the_best_of_all_that_can_be_built_by_hand(turn):
    """For each offset and crank the coupler that makes the stroke is looked up among many, and moved."""
    best = slider_crank_stroke(1.0, turn)
    # The pivot from which the slider's two ends are seen under the turn less half a turn lies on a circle.
    seen = np.radians(turn - 180)
    centre = 0.5 + 0.5j / np.tan(seen)
    pivot = centre + abs(centre) * np.exp(1j * np.linspace(0, 2 * np.pi, 8001))
    near, far = abs(pivot), abs(1 - pivot)
    sizes = np.array([0.5 * (far - near), 0.5 * (far + near), -pivot.imag])[:, far - near > 1e-3]
    top, drive = 0.0, np.linspace(0, 2 * np.pi, 361)
    for part in np.array_split(sizes, 8, axis=1):
        motion = gk.move(gk.SliderCrank(*part), drive)
        place = motion.slider.origin.position.real
        rising = 360 * np.mean(np.diff(place, axis=0) > 0, axis=0)
        fits = motion.assembled.all(axis=0) & (abs(np.ptp(place, axis=0) - 1) < 1e-3) & (abs(rising - turn) < 2.1)
        top = max(top, np.degrees(np.where(fits, motion.transmission_angle.min(axis=0), 0)).max(initial=0))
    assert best.transmission_angle_deg - 2e-3 < top < best.transmission_angle_deg + 1e-6


def test_a_known_slider_crank_is_found_again_by_each_of_its_sizes():
    rng = np.random.default_rng(3)
    count = 0
    for _ in range(16):
        crank, coupler, offset = rng.uniform(0.2, 1), rng.uniform(0.5, 3), rng.uniform(-1, 1)
        if crank + abs(offset) > coupler - 0.02 or abs(offset) < 0.01:
            continue
        known = gk.SliderCrank(crank, coupler, offset)
        dead = gk.linkage.dead_centres(known, "slider", 1, (-0.1, 2 * np.pi - 0.1))
        places = gk.move(known, dead).slider.origin.position.real
        turn = np.degrees(dead[1] - dead[0]) if places[1] > places[0] else 360 - np.degrees(dead[1] - dead[0])
        for name in ("crank", "coupler", "offset"):
            again = slider_crank_stroke(float(np.ptp(places)), float(turn), **{name: getattr(known, name)})
            assert list(again.lengths.values()) == pytest.approx([crank, coupler, offset], rel=1e-6)
            assert getattr(again.linkage, name) == getattr(known, name) and again.defects == ()
        count += 1
    assert count > 3


def test_a_mirrored_wish_is_a_mirrored_linkage():
    one, other = slider_crank_stroke(80, 200), slider_crank_stroke(80, 160)
    assert one.linkage.offset < 0 < other.linkage.offset
    assert one.linkage.offset == pytest.approx(-other.linkage.offset)
    assert one.transmission_angle_deg == pytest.approx(other.transmission_angle_deg, abs=1e-9)
    assert one.time_ratio == pytest.approx(200 / 160)


def test_at_half_a_turn_the_slide_line_goes_through_the_pivot():
    best = slider_crank_stroke(100)
    assert best.at_largest_ratio and best.ratio == pytest.approx(6) and best.linkage.offset == 0
    few = slider_crank_stroke(100, 180, largest_ratio=4)
    assert (few.linkage.crank, few.linkage.coupler) == pytest.approx((50, 200))
    assert few.transmission_angle_deg == pytest.approx(np.degrees(np.arccos(0.25)))
    assert slider_crank_stroke(100, offset=0, largest_ratio=4).linkage == few.linkage
    assert slider_crank_stroke(100, coupler=120).linkage == gk.SliderCrank(50, 120)
    obeys(100, 180, few)


def test_reported_family_agrees_with_the_motion_of_its_members():
    best = slider_crank_stroke(50, 165)
    members = gk.move(best.family.linkage, np.radians(np.arange(0, 361, 1.0)))
    assert members.assembled.all()
    least = np.degrees(members.transmission_angle.min(axis=0))
    assert best.family.transmission_angle_deg == pytest.approx(least, abs=1e-9)
    assert np.ptp(members.slider.origin.position.real, axis=0) == pytest.approx(50, rel=3e-3)
    assert best.family.transmission_angle_deg.max() <= best.transmission_angle_deg


@pytest.mark.parametrize(
    ("wish", "field"),
    [
        ({"crank_turn_deg": 90}, "crank_turn_deg"),
        ({"stroke": 0}, "stroke"),
        ({"crank_turn_deg": 160, "offset": -3}, "offset"),
        ({"crank_turn_deg": 200, "crank": 300}, "crank"),
        ({"crank_turn_deg": 200, "coupler": 20}, "coupler"),
        ({"offset": 4}, "offset"),
        ({"crank": 40}, "crank"),
        ({"crank_turn_deg": 200, "crank": 45, "offset": -3}, "crank"),
        ({"free_angle_deg": 45}, "free_angle_deg"),
        ({"largest_ratio": 1}, "largest_ratio"),
    ],
)
def test_invalid_requests_are_refused(wish, field):
    with pytest.raises(gk.DesignError) as caught:
        slider_crank_stroke(**{"stroke": 100} | wish)
    assert caught.value.field == field and caught.value.remedy
