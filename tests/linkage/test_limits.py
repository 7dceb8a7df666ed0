"""Driver limits, dead centres, mechanical advantage, coupler curves."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.examples import ALL, FOUR_BAR, boom


def test_a_crank_that_turns_fully_has_no_limits():
    assert gk.driver_limits(FOUR_BAR) == ((0.0, 2 * np.pi),)
    assert gk.driver_limits(gk.SliderCrank(30, 90, 12)) == ((0.0, 2 * np.pi),)


@pytest.mark.parametrize(
    ("linkage", "span"),
    [
        (gk.FourBar(4, 3, 2, 2.5), (-np.pi, np.pi)),
        (gk.FourBar(100, 30, 90, 70, driver="rocker"), (0, 2 * np.pi)),
        (gk.FourBar(100, 30, 90, 70, driver="coupler"), (-np.pi, np.pi)),
        (gk.SliderCrank(30, 90, 12, driver="coupler"), (-np.pi, np.pi)),
        (gk.SliderCrank(90, 30, 12), (0, 2 * np.pi)),
        (gk.SliderCrank(30, 90, 12, driver="slider"), (0, 300)),
        (gk.StephensonSixBar(FOUR_BAR, 40, 60, 60 + 120j), (0, 2 * np.pi)),
        (gk.InvertedSliderCrank(80, 30, 0, driver="rocker"), (0, 2 * np.pi)),
    ],
)
def test_limits_separate_assembled_from_open_drives(linkage, span):
    parts = gk.driver_limits(linkage, span=span)
    drive = np.linspace(*span, 5000)[1:-1]
    inside = np.any([(low <= drive) & (drive <= high) for low, high in parts], axis=0)
    assert np.array_equal(inside, gk.move(linkage, drive).assembled)
    for edge in {e for part in parts for e in part} - set(span):
        # At the limit a dyad is stretched or folded.
        near = [gk.move(linkage, [edge + k * 1e-9 * (span[1] - span[0])]) for k in (-1, 1)]
        assert [m.assembled[0] for m in near].count(True) == 1
        assert min(m.transmission_angle[0] for m in near if m.assembled[0]) < 1e-3


def test_the_crank_of_a_non_grashof_linkage_stops_where_coupler_and_rocker_stretch():
    ((low, high),) = gk.driver_limits(gk.FourBar(4, 3, 2, 2.5), span=(-np.pi, np.pi))
    reach = abs(4 - 3 * np.exp(1j * high))
    assert low == -high and reach == pytest.approx(2 + 2.5, rel=1e-14)


def test_a_span_without_a_pose_has_no_parts():
    assert gk.driver_limits(gk.FourBar(4, 3, 2, 2.5), span=(2.0, 4.0)) == ()


@pytest.mark.parametrize("size", [1e-7])
def test_a_driving_slide_is_followed_over_its_whole_reach(size):
    """By Pythagoras: crank and coupler in line, stretched or folded, 12 mm beside the slide."""
    linkage = gk.SliderCrank(30 * size, 90 * size, 12 * size, driver="slider")
    far, near = np.sqrt(120**2 - 12**2), np.sqrt(60**2 - 12**2)
    found = np.array(gk.driver_limits(linkage)) / size
    assert found == pytest.approx(np.array([[-far, -near], [near, far]]), rel=1e-14)
    # The coupler turns back where the crank stands across the slide.
    centres = gk.linkage.dead_centres(linkage, "coupler") / size
    assert centres == pytest.approx([-np.sqrt(90**2 - 42**2), np.sqrt(90**2 - 18**2)], rel=1e-14)


@pytest.mark.parametrize("short", [1.0, 1e-9])
def test_a_slide_that_closes_hardly_anywhere_is_found(short):
    """Crank and coupler just reach the slide's line, so that the whole stroke is a sliver of their lengths."""
    offset = 120 - short
    stroke = np.sqrt((120 - offset) * (120 + offset))
    linkage = gk.SliderCrank(30, 90, offset, driver="slider").linkage
    (slider,) = linkage.sliders
    # Displacements are measured from a point of the line that no sample meets.
    away = replace(linkage, sliders=(replace(slider, through=slider.through - 7.31 * slider.direction),))
    ((low, high),) = gk.driver_limits(away)
    assert [low - 7.31, high - 7.31] == pytest.approx([-stroke, stroke], rel=1e-13 / short + 1e-13)


def test_an_actuator_is_followed_over_its_whole_reach():
    """By the triangle of its pins: the boom's arm against its base, the rod's slide 5 mm beside the pins."""
    linkage = boom()
    parts = gk.driver_limits(linkage)
    slide = linkage.sliders[0]
    arm, base = abs(120 + 10j), abs(60 - 80j)
    # Where the rod's pin is seen from the cylinder's as the slide moves on.
    start, along = (
        slide.in_other_frame("rod", -5, 0.0),
        slide.in_other_frame("rod", -5, 1.0) - slide.in_other_frame("rod", -5, 0.0),
    )
    ahead, left = (start * np.conj(along)).real, (start * np.conj(along)).imag
    far, near = np.sqrt((arm + base) ** 2 - left**2), np.sqrt((arm - base) ** 2 - left**2)
    assert np.array(parts) + ahead == pytest.approx(np.array([[-far, -near], [near, far]]), rel=1e-13)


@pytest.mark.parametrize(("lean", "height"), [(1.0, 0.0), (1e-4, 1000.0)])
def test_a_slide_s_reach_may_be_far_beyond_the_linkage_s_lengths(lean, height):
    """A rod between two rails: its ends lie 100 mm over the sine of the rails' angle from where they cross."""
    linkage = gk.Linkage(
        {"ground": {}, "one": {"A": 0}, "rod": {"A": 0, "B": 100}, "two": {"B": 0}},
        "one",
        (
            gk.Slider("level", "one", "ground"),
            gk.Slider("leaning", "two", "ground", through=1j * height, direction_deg=np.degrees(lean)),
        ),
    )
    crossing, reach = -height / np.tan(lean), 100 / np.sin(lean)
    assert np.ravel(gk.driver_limits(linkage)) == pytest.approx([crossing - reach, crossing + reach], rel=1e-12)


def test_a_slide_that_closes_nowhere_has_neither_limits_nor_dead_centres():
    """Its line passes the cylinder's pin farther off than arm and base are long together."""
    lift = boom()
    never = gk.Linkage(lift.bodies, "lift", (replace(lift.sliders[0], through=700j),))
    assert gk.driver_limits(never) == () and gk.linkage.dead_centres(never, "boom").size == 0


def test_dead_centres_of_a_crank_rocker_have_crank_and_coupler_in_line():
    found = gk.linkage.dead_centres(FOUR_BAR, "rocker")
    motion = gk.move(FOUR_BAR, found)
    assert len(found) == 2
    assert np.abs(np.imag(motion.crank.direction * np.conj(motion.coupler.direction))).max() < 1e-14
    pin = np.abs(motion.point("rocker_pin").position)
    assert sorted(pin) == pytest.approx([90 - 30, 90 + 30], rel=1e-14)


def test_dead_centres_of_a_slider_crank_are_its_extreme_strokes():
    found = gk.linkage.dead_centres(gk.SliderCrank(30, 90, 12), "slider")
    places = gk.move(gk.SliderCrank(30, 90, 12), found).slider.origin.position.real
    assert sorted(places) == pytest.approx([np.sqrt(60**2 - 12**2), np.sqrt(120**2 - 12**2)], rel=1e-14)


@pytest.mark.parametrize("name", ["four-bar", "slider-crank", "shaper", "watt", "scotch yoke"])
def test_mechanical_advantage_conserves_power(name):
    """Virtual work by differences: what the driver moves times its torque is what the output gives back."""
    linkage, drive, branch = ALL[name]
    output = {"four-bar": "rocker", "slider-crank": "slider", "shaper": "ram", "watt": "output", "scotch yoke": "yoke"}[
        name
    ]
    step = 1e-6
    here, before, after = (gk.move(linkage, drive[1:-1] + d, branch) for d in (0, -step, step))
    bodies = [m.bodies[output] for m in (before, after)]
    turned = np.angle(bodies[1].direction / bodies[0].direction) / (2 * step)
    ahead = here.bodies["ground"].direction * (1j if name == "shaper" else 1)
    slid = np.real(np.conj(ahead) * (bodies[1].origin.position - bodies[0].origin.position)) / (2 * step)
    way = slid if output in ("slider", "ram", "yoke") else turned
    advantage = gk.linkage.mechanical_advantage(here, output)
    clear = np.abs(way) > 1e-3 * np.abs(way).max()
    assert advantage[clear] * way[clear] == pytest.approx(np.ones(clear.sum()), rel=1e-5)


@pytest.mark.parametrize("size", [1e-7])
@pytest.mark.parametrize(("coupler", "rocker"), [(80, 30), (np.array([80, 80, 82]), np.array([30, 30, 40]))])
def test_a_platform_on_two_cranks_gives_a_force_along_its_path(size, coupler, rocker):
    """Virtual work by differences; the rounding of a platform that does not turn is no turning."""
    linkage = gk.FourBar(80 * size, 30 * size, coupler * size, rocker * size)
    drive, step = np.linspace(0.3, 2.6, 20), 1e-6
    advantage = gk.linkage.mechanical_advantage(gk.move(linkage, drive, "follow"), "coupler")
    ends = [gk.move(linkage, np.append(0.3, drive + d), "follow").coupler for d in (-step, step)]
    gone = np.abs(ends[1].origin.position - ends[0].origin.position)[1:] / (2 * step)
    turned = np.angle(ends[1].direction / ends[0].direction)[1:] / (2 * step)
    way = gone if advantage.ndim == 1 else np.column_stack([gone[:, 0], gone[:, 1], turned[:, 2]])
    assert advantage * way == pytest.approx(np.ones(way.shape), rel=1e-5)


@pytest.mark.parametrize(
    ("linkage", "output", "dead_centres"),
    [
        (gk.SliderCrank(150, 600), "slider", np.radians([0, 180, -180, -360, 360, 720])),
        (gk.SliderCrank(150, 600), "coupler", np.radians([90, 270, -90])),
        (gk.ScotchYoke(30, 90), "yoke", np.radians([0, 180, 360])),
        # Crank and coupler in line, by the law of cosines.
        (gk.FourBar(4, 1, 4, 3), "rocker", [np.arccos(32 / 40), np.pi + np.arccos(16 / 24)]),
        (gk.InvertedSliderCrank(80, 30, 0), "rocker", [np.arccos(30 / 80), -np.arccos(30 / 80)]),
    ],
)
def test_the_advantage_is_infinite_at_every_dead_centre_and_finite_next_to_it(linkage, output, dead_centres):
    advantage = gk.linkage.mechanical_advantage(gk.move(linkage, dead_centres), output)
    assert np.all(advantage == np.inf)
    near = [gk.linkage.mechanical_advantage(gk.move(linkage, np.add(dead_centres, d)), output) for d in (-1e-9, 1e-9)]
    assert np.isfinite(near).all() and np.all(np.sign(near[0]) != np.sign(near[1]))


def test_other_bodies_keep_their_advantage_where_one_runs_away():
    """A sled at the dead centre of its driver: the rates of the crank are infinite, those of the rail are not."""
    motion = gk.move(gk.SliderCrank(30, 90, driver="slider"), [120.0, 100.0])
    assert gk.linkage.mechanical_advantage(motion, "crank")[0] == 0
    assert gk.linkage.mechanical_advantage(motion, "slider")[0] == 1


def test_the_error_amplification_of_flat_parallelograms_is_infinite():
    assert np.isinf(
        gk.move(gk.FourBar(80, 30, 80, 30), np.radians([0, 180, 360, 540]), "follow").error_amplification
    ).all()


def test_a_coupler_curve_is_the_path_of_its_point_exactly():
    curve = gk.CouplerCurve(FOUR_BAR, "coupler_point")
    t = np.linspace(0, 2 * np.pi, 50)
    assert np.array_equal(curve.point(t), gk.move(FOUR_BAR, t).point("coupler_point").position)
    assert curve.closed and curve.point(t.reshape(5, 10)).shape == (5, 10)
    step = 1e-5
    assert curve.velocity(t) == pytest.approx((curve.point(t + step) - curve.point(t - step)) / (2 * step), abs=1e-6)
    # Curvature against the circle through three near points of the path.
    a, b, c = (curve.point(t + d) for d in (-1e-4, 0, 1e-4))
    circle = 2 * np.imag(np.conj(b - a) * (c - b)) / (abs(b - a) * abs(c - b) * abs(c - a))
    assert curve.curvature(t) == pytest.approx(circle, rel=1e-4, abs=1e-6)


def tangent_drive():
    """A pin in a slot of the crank and in one along x, 5 mm off: it runs away where the crank points along x."""
    return gk.Linkage(
        {"ground": {"O": 0}, "crank": {"O": 0}, "block": {"P": 0}, "yoke": {"P": 0}},
        "crank",
        (gk.Slider("radial", "block", "crank"), gk.Slider("way", "yoke", "ground", through=5j)),
    )


def test_dashes_across_parallel_guides_are_refused():
    with pytest.raises(gk.DesignError) as caught:
        gk.linkage.dashes(tangent_drive(), [0j], [np.pi - 1, np.pi + 1], 0.1, body="block")
    assert caught.value.field == "drive" and "3.14159" in caught.value.problem
    ends = [np.pi - 1, np.pi - 0.1, np.pi + 0.1, np.pi + 1]
    (dashes,) = gk.linkage.dashes(tangent_drive(), [0j], ends, 0.1, body="block")
    for dash, (low, high) in zip(dashes, (ends[:2], ends[2:]), strict=True):
        assert dash.imag == pytest.approx(5) and dash[[0, -1]].real == pytest.approx(5 / np.tan([low, high]))


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("turn", [0, 40])
def test_a_sliding_body_is_pushed_along_its_line_whichever_of_the_two_names_it(swapped, turn):
    """One over the sliding speed of the joint, as reported."""
    given = gk.SliderCrank(30, 90, 12).linkage
    slide = gk.Slider("slide", "slider", "ground", 0, 12j, turn, turn)
    if swapped:
        slide = gk.Slider("slide", "ground", "slider", 12j, 0, 0, -turn)
    linkage = replace(given, sliders=(slide,))
    motion = gk.move(linkage, np.linspace(0.2, 6.0, 17))
    advantage = gk.linkage.mechanical_advantage(motion, "slider")
    assert advantage == pytest.approx(1 / motion.slide("slide").first, rel=1e-9)
    assert (advantage > 0).any() and (advantage < 0).any()


@pytest.mark.parametrize("size", [1e-6, 1e7])
def test_a_curve_over_whole_turns_is_closed_at_any_size_and_over_less_it_is_not(size):
    linkage = gk.FourBar(*(size * n for n in (100, 30, 90, 70)), coupler_point=size * (40 + 25j))
    assert gk.CouplerCurve(linkage, "coupler_point").closed
    assert gk.CouplerCurve(linkage, "coupler_point", span=(1.0, 1.0 + 4 * np.pi)).closed
    for end in (1 + np.pi, 1 + 2 * np.pi - 1e-7):
        assert not gk.CouplerCurve(linkage, "coupler_point", span=(1.0, end)).closed


@pytest.mark.parametrize("turns", [(0, 1), (-2.5, 0.75)])
@pytest.mark.parametrize("name", ["engine, leaning", "yoke", "rods"])
def test_dead_centres_of_symmetric_linkages(name, turns):
    """Samples meet them, or miss them by a last bit; at the ends of the span they may be reported or not."""
    linkage, output, first = {
        "engine": (gk.SliderCrank(30, 90), "slider", 0.0),
        "engine, leaning": (gk.SliderCrank(30, 90, ground_angle_deg=40), "slider", 0.0),
        "yoke": (gk.ScotchYoke(30, 90), "yoke", 0.0),
        "rods": (gk.SliderCrank(30, 90), "coupler", 0.5),
    }[name]
    found = gk.linkage.dead_centres(linkage, output, 1, (turns[0] * 2 * np.pi, turns[1] * 2 * np.pi)) / np.pi
    inside = np.abs(np.abs(found - np.mean(turns) * 2) - np.ptp(turns)) > 1e-9
    wanted = np.arange(-6, 6) + first
    wanted = wanted[(2 * turns[0] + 1e-9 < wanted) & (wanted < 2 * turns[1] - 1e-9)]
    assert found[inside] == pytest.approx(wanted, abs=1e-12)


def test_a_platform_on_two_cranks_stands_still_where_these_do():
    """Its points run along arcs, on which it goes at its fastest square to where it went before."""
    bodies = {name: dict(points) for name, points in FOUR_BAR.linkage.bodies.items()}
    bodies["ground"] |= {"E": 100 + 50j}
    bodies["rocker"] |= {"P": 40 + 60j}
    bodies |= {"second": {"E": 0, "Q": 40 + 60j}, "platform": {"P": 0, "Q": 50j}}
    bars = gk.Linkage(bodies, "crank")
    for span in (None, (-4.0, 5.0)):
        found = gk.linkage.dead_centres(bars, "platform", "follow", span)
        assert found == pytest.approx(gk.linkage.dead_centres(bars, "rocker", "follow", span)) and len(found) >= 2
    swing = np.angle(gk.move(bars, found[:2], "follow").rocker.direction)
    assert abs(swing[1] - swing[0]) > 0.5
    # Cranks that turn on never let it stand.
    for lengths in ((100, 30), (30, 100)):
        round_and_round = gk.FourBar(*lengths, *lengths)
        assert gk.linkage.dead_centres(round_and_round, "coupler", "follow").size == 0
        assert gk.linkage.dead_centres(round_and_round, "rocker", "follow").size == 0


@pytest.mark.parametrize("lean", [-2.9, 1.8])
def test_limits_come_again_each_turn_however_the_crank_s_pin_lies_in_it(lean):
    bodies = {
        "ground": {"O": 0, "C": 4 * np.exp(-0.8j * lean)},
        "crank": {"O": 0, "A": 3 * np.exp(1j * lean)},
        "coupler": {"A": 0, "B": 2},
        "rocker": {"C": 0, "B": 2.5},
    }
    linkage, half = gk.Linkage(bodies, "crank"), np.arccos((4**2 + 3**2 - 4.5**2) / (2 * 4 * 3))
    limits = np.ravel([[-1.8 * lean - half, -1.8 * lean + half]] + 2 * np.pi * np.arange(-6, 7)[:, None])
    for start in np.arange(-13, 13, 1.1).tolist():
        span = (start, start + 2 * np.pi)
        found = np.ravel(gk.driver_limits(linkage, span=span))
        wanted = limits[(span[0] < limits) & (limits < span[1])]
        assert [q for q in found.tolist() if q not in span] == pytest.approx(wanted.tolist(), abs=1e-12)
