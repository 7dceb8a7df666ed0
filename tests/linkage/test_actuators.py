"""A slider as the driver: cylinder and rod between any two bodies, against other drivers, 60 digits and statics."""

import dataclasses
from decimal import Decimal

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.exact import actuator
from tests.linkage.examples import ALL, between, boom, lift_table

ULPS = 8 * np.finfo(float).eps
# name: (linkage driven by its slide, branch, another driver of it, that one's angles)
SAME = {
    "boom": (boom(), 1, "boom", np.linspace(0.3, 1.2, 30)),
    "boom after its cylinder": (boom(("rod", "cylinder", "boom")), -1, "boom", np.linspace(0.3, 1.2, 30)),
    "boom, the cylinder slides": (boom(turned=True), 1, "boom", np.linspace(0.3, 1.2, 30)),
    "boom by the cylinder": (boom(), -1, "cylinder", np.linspace(0.5, 0.9, 30)),
    "lift table": (lift_table(), 1, "arm", np.linspace(0.2, 0.9, 30)),
    "between moving bars": (between()[0], 1, "crank", between()[3]),
}


@pytest.mark.parametrize("name", SAME)
def test_motion_does_not_depend_on_the_driver(name):
    linkage, branch, driver, angle = SAME[name]
    other = dataclasses.replace(linkage, driver=driver)
    (slider,) = (s for s in linkage.sliders if s.name == linkage.driver)
    given = next(m for m in (gk.move(other, angle, side, 3.0, -2.0) for side in (1, -1)) if _right(m, linkage, branch))
    slide = given.slide(slider.name)
    driven = gk.move(linkage, slide.displacement, branch, slide.velocity, slide.acceleration)
    assert driven.assembled.all()
    for body in linkage.bodies:
        one, two = given.bodies[body], driven.bodies[body]
        assert np.abs(one.direction - two.direction).max() < 1e-12
        assert one.omega == pytest.approx(two.omega, rel=1e-9, abs=1e-9)
        assert one.alpha == pytest.approx(two.alpha, rel=1e-7, abs=1e-7)
        places = one.point(3 + 4j), two.point(3 + 4j)
        assert np.abs(places[0].position - places[1].position).max() < 1e-9
        assert places[0].velocity == pytest.approx(places[1].velocity, rel=1e-8, abs=1e-8)
        assert places[0].acceleration == pytest.approx(places[1].acceleration, rel=1e-6, abs=1e-6)
    back = driven.slide(slider.name)
    assert back.displacement == pytest.approx(driven.drive, abs=1e-11)
    assert back.velocity == pytest.approx(slide.velocity, rel=1e-10)
    assert back.acceleration == pytest.approx(slide.acceleration, rel=1e-8, abs=1e-8)


def _right(motion, linkage, branch):
    """Whether a motion stands on the branches that the actuated linkage is asked to stand on."""
    if not motion.assembled.all():
        return False
    stroke = motion.slide(linkage.driver).displacement
    driven = gk.move(linkage, stroke, branch)
    return all(np.abs(motion.bodies[b].direction - driven.bodies[b].direction).max() < 1e-6 for b in linkage.bodies)


DRIVEN_BY_SLIDERS = ["slider-crank by slider", "trammel by shuttle", "boom", "boom after its cylinder",
                     "boom, the cylinder slides", "boom, pulled through", "pushed crosshead", "lift table",
                     "actuator between moving bars"]  # fmt: skip


@pytest.mark.parametrize("name", DRIVEN_BY_SLIDERS)
def test_driven_slide_has_the_given_displacement(name):
    linkage, drive, branch = ALL[name]
    general = linkage.linkage
    motion = gk.move(linkage, drive, branch, speed=3.0, acceleration=-2.0)
    slide = motion.slide(general.driven_slider.name)
    assert slide.displacement == pytest.approx(drive, abs=1e-11)
    assert slide.velocity == pytest.approx(np.full(len(drive), 3.0)) and slide.acceleration == pytest.approx(
        np.full(len(drive), -2.0), abs=1e-8
    )
    # The rod points along the cylinder, not against it.
    s = general.driven_slider
    turn = motion.bodies[s.body].direction * np.conj(motion.bodies[s.along].direction)
    assert np.abs(turn - s.direction * np.exp(1j * np.radians(s.angle_deg))).max() < 1e-12


def bar_on_actuator(still, bar, offset, first=True):
    bodies = {"cylinder": {"C": 0}, "rod": {"B": 0}, "bar": {"O": 0, "B": bar}}
    order = list(bodies) if first else ["bar", "cylinder", "rod"]
    return gk.Linkage(
        {"ground": {"C": 0, "O": still}, **{name: bodies[name] for name in order}},
        "push",
        (gk.Slider("push", "rod", "cylinder", through=1j * offset),),
    )


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("scale", [1e-7])
def test_digits_at_every_gap_and_size(scale, first):
    """Against 60 digits: where a slide past its pin nearly lets the triangle fold, and far from there."""
    rng, worst = np.random.default_rng(3), np.zeros(3)
    for gap in 10.0 ** -np.arange(0, 16):
        for folded in (1, -1):
            bar, offset = rng.uniform(1.0, 1.5, 2) * scale
            sizes = bar + offset + folded * gap * min(bar, offset) * 0.5, bar, offset
            nearest = np.sqrt(max(0.0, (sizes[0] - bar) ** 2 - offset**2))
            place = nearest + rng.uniform(0.3, 1.0) * scale * np.sqrt(gap) * rng.choice([-1, 1] if folded < 0 else [1])
            for branch in (1, -1):
                motion = gk.move(bar_on_actuator(*sizes, first), [place], branch if first else -branch)
                exact = actuator(*sizes, place, branch)
                for k, what in enumerate(("direction", "first", "second")):
                    found = np.array([getattr(motion.bodies[b], what)[0] for b in ("rod", "bar")]) * scale**k
                    wanted = np.array(exact[k]) * scale**k
                    # Near a limit the place's own rounding is seen in the pose, by 1/r, and in its rates.
                    condition = 1 + place / (place - nearest) if folded > 0 else 1.0
                    error = np.abs(found - wanted).max() / max(1.0, np.abs(wanted).max()) / condition
                    worst[k] = max(worst[k], error)
    assert np.all(worst < ULPS)


@pytest.mark.parametrize("scale", [1e7])
@pytest.mark.parametrize(("still", "bar", "offset"), [(100, 60, 0), (100, 60, 25), (60, 100, -25), (100, 60, 55)])
def test_limits_are_those_of_the_triangle(still, bar, offset, scale):
    """Law of cosines: the pins come as near as the bars' difference and as far as their sum, and no further."""
    linkage = bar_on_actuator(still * scale, bar * scale, offset * scale)
    far, near = np.sqrt((still + bar) ** 2 - offset**2), (still - bar) ** 2 - offset**2
    expected = [-far, far] if near < 0 else [-far, -np.sqrt(near), np.sqrt(near), far]
    parts = gk.driver_limits(linkage, span=(-300 * scale, 300 * scale))
    found = np.array(parts).ravel() / scale
    assert found == pytest.approx(expected, rel=1e-14)
    for k, edge in enumerate(found * scale):
        inside = 1 if k % 2 == 0 else -1
        assert gk.move(linkage, [edge + inside * 1e-12 * abs(edge)]).assembled[0]
        assert not gk.move(linkage, [edge - inside * 1e-12 * abs(edge)]).assembled[0]


@pytest.mark.parametrize("gap", 10.0 ** -np.arange(0, 16, 7))
def test_a_crosshead_keeps_its_digits_where_slide_and_rail_pass_the_pin_alike(gap):
    """Against 60 digits: a slide that passes its pin at nearly the rail's height."""
    height, place = 1.3, 0.7 * np.sqrt(gap)
    linkage = gk.Linkage(
        {"ground": {"C": 0}, "cylinder": {"C": 0}, "rod": {"B": 0}, "head": {"B": 0}},
        "push",
        (
            gk.Slider("rail", "head", "ground", through=1j * height),
            gk.Slider("push", "rod", "cylinder", 0, 1j * (height + gap)),
        ),
    )
    x, n, k = Decimal(place), Decimal(height + gap), Decimal(height)
    head = (x * x + n * n - k * k).sqrt()
    motion = gk.move(linkage, [place])
    found = motion.head.origin
    assert found.first[0].real == pytest.approx(float(x / head), rel=ULPS)
    assert found.second[0].real == pytest.approx(float((head * head - x * x) / head**3), rel=ULPS)
    turning = (n - k * x / head) / (x * x + n * n)
    assert motion.rod.first[0] == pytest.approx(float(turning), rel=ULPS)


def test_rod_of_a_braced_cylinder_moves_in_a_straight_line():
    """The cylinder is held by a strut, so that the rod's end goes along its line by what it is driven."""
    linkage = gk.Linkage(
        {
            "ground": {"C": 0, "D": 60, "O": 150 - 20j},
            "cylinder": {"C": 0, "K": 40},
            "strut": {"D": 0, "K": 50},
            "rod": {"B": 5 + 1j},
            "link": {"B": 0, "E": 70},
            "crank": {"O": 0, "E": 60},
        },
        "push",
        (gk.Slider("push", "rod", "cylinder"),),
    )
    q = np.linspace(30, 60, 20)
    motion = gk.move(linkage, q, {"K": -1})
    # The brace by the law of cosines.
    lean = np.arccos((60**2 + 40**2 - 50**2) / (2 * 60 * 40))
    assert motion.assembled.all() and motion.residual.max() < 1e-12
    assert motion.point("B").position == pytest.approx((q + 5 + 1j) * motion.cylinder.direction)
    assert np.abs(np.angle(motion.cylinder.direction)) == pytest.approx(np.full(20, lean))
    assert motion.cylinder.first == pytest.approx(0) and motion.point("B").first == pytest.approx(
        motion.cylinder.direction
    )


def test_a_gap_too_narrow_to_be_looked_at_is_found():
    near = gk.driver_limits(bar_on_actuator(100, 99.99, 0), span=(-300, 300))
    assert np.array(near).ravel() == pytest.approx([-199.99, -0.01, 0.01, 199.99], rel=1e-11)


@pytest.mark.parametrize("order", [["cylinder", "rod", "bar"], ["bar", "rod", "cylinder"]])
def test_a_change_point_is_followed(order):
    """A slide that passes by its pin at just the height where the triangle folds: the bar swings on, or back."""
    plain = bar_on_actuator(100, 60, 40)
    linkage = dataclasses.replace(plain, bodies={name: plain.bodies[name] for name in ["ground", *order]})
    q = np.linspace(-50, 50, 101)
    on, back = gk.move(linkage, q, "follow"), gk.move(linkage, q)
    turned = np.diff(np.unwrap(np.angle(on.bar.direction)))
    assert on.assembled.all() and np.all(turned < 0) | np.all(turned > 0)
    assert set(on.branches["B"][:50]) == {1} and set(on.branches["B"][51:]) == {-1} and on.branches["B"][50] == 0
    assert on.residual.max() < 1e-12
    step = 1e-4
    near = [gk.move(linkage, [q[0], *(q + d)], "follow").bar for d in (-step, step)]
    rate = np.angle(near[1].direction[1:] * np.conj(near[0].direction[1:])) / (2 * step)
    assert rate == pytest.approx(on.bar.first, rel=1e-6)
    assert (near[1].first - near[0].first)[1:] / (2 * step) == pytest.approx(on.bar.second, rel=1e-5, abs=1e-9)
    swung = np.diff(np.unwrap(np.angle(back.bar.direction)))
    assert np.sign(swung[10]) == -np.sign(swung[-10])
    assert gk.driver_limits(linkage, "follow", (-50, 50)) == ((-50, 50),)


def test_batch_of_actuators_equals_single_ones():
    rng = np.random.default_rng(5)
    still, bar, offset = rng.uniform(50, 100, 20), rng.uniform(30, 80, 20), rng.uniform(-30, 30, 20)
    q = np.linspace(20, 120, 50)
    many = gk.move(bar_on_actuator(still, bar, offset), q)
    for k in range(20):
        alone = gk.move(bar_on_actuator(still[k], bar[k], offset[k]), q)
        assert np.array_equal(many.assembled[:, k], alone.assembled)
        for body in ("rod", "bar"):
            one, two = many.bodies[body].second[:, k], alone.bodies[body].second
            assert one[alone.assembled] == pytest.approx(two[alone.assembled], rel=1e-12)


def test_force_and_torque_are_in_balance():
    """Statics: the actuator pushes along the line through its pins, and its share along the slide is the force."""
    linkage = boom()
    motion = gk.move(linkage, np.linspace(40, 150, 30), -1)
    pivot, pin, base = (motion.point(name).position for name in "OBC")
    push = (pin - base) / np.abs(pin - base)
    slide = motion.cylinder.direction * linkage.sliders[0].direction
    torque = np.imag(np.conj(pin - pivot) * push) / np.real(np.conj(push) * slide)
    assert gk.linkage.mechanical_advantage(motion, "boom") == pytest.approx(torque, rel=1e-12)
    # Where the line of push passes by the boom's pivot the linkage is at its limit, the least angle shows it.
    lean = np.arcsin(np.abs(np.imag(np.conj(pin - pivot) * push)) / np.abs(pin - pivot))
    assert motion.transmission_angle == pytest.approx(lean, rel=1e-12)


def test_dead_centre_of_an_offset_slide():
    found = gk.linkage.dead_centres(bar_on_actuator(100, 60, 55), "bar", span=(-130, 100))
    assert found == pytest.approx([0.0], abs=1e-12)


def test_rising_table_has_no_dead_centre():
    """That rounding turns it by next to nothing does not make its angle what is looked at."""
    assert gk.linkage.dead_centres(lift_table(), "table", span=(100, 180)).size == 0
    motion = gk.move(lift_table(), np.linspace(100, 180, 50))
    assert np.all(motion.table.origin.first.imag > 0)


@pytest.mark.parametrize("swapped", [False, True])
def test_a_slide_on_the_ground_may_be_named_by_its_body_or_by_itself(swapped):
    """Named by itself its own displacement is driven, whichever of the two is said to slide."""
    ends = ("ground", "head") if swapped else ("head", "ground")
    bodies = {"ground": {"O": 0}, "crank": {"O": 0, "A": 30}, "rod": {"A": 0, "B": 90}, "head": {"B": 0}}
    slider = gk.Slider("rail", *ends, through=2 - 5j, direction_deg=10)
    q = np.linspace(70, 110, 20) * (-1 if swapped else 1)
    by_slide = gk.move(gk.Linkage(bodies, "rail", (slider,)), q)
    assert by_slide.assembled.all() and by_slide.slide("rail").displacement == pytest.approx(q)
    by_body = gk.move(gk.Linkage(bodies, "head", (slider,)), np.abs(q))
    assert np.abs(by_body.crank.direction - by_slide.crank.direction).max() < 1e-13


def test_an_actuator_among_loops_reaches_as_far_as_the_bars_it_pushes_apart():
    """The longest that crank and rocker draw it, by narrowing down the crank's angle where they do."""
    linkage, stroke, by_crank, _ = between()

    def drawn(angle):
        motion = gk.move(by_crank, angle)
        return np.sqrt(np.abs(motion.point("K").position - motion.point("L").position) ** 2 - 3**2) - 20

    low, high = -0.5, 0.9
    for _ in range(12):
        angles = np.linspace(low, high, 21)
        top = int(np.argmax(drawn(angles)))
        low, high = angles[max(top - 1, 0)], angles[min(top + 1, 20)]
    ((start, end),) = gk.driver_limits(linkage, span=(stroke[0], stroke[0] + 40))
    assert start == stroke[0] and end == pytest.approx(drawn(np.array([low]))[0], rel=1e-12)
    angles = gk.move(linkage, [stroke[0], end - 1e-2, end - 1e-6]).transmission_angle
    assert angles[1] < 0.1 and angles[2] < 1.1e-2 * angles[1]
