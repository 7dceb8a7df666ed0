"""Every linkage by second roads: lengths kept, central differences, time histories, other solvers."""

from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.moving import plan
from geomkin.linkage.solve.loops import Loops
from tests.campaign import by_default
from tests.linkage.examples import ALL, FEW, FOUR_BAR, TURN, crossed_slots, locked


@pytest.fixture(params=ALL)
def example(request):
    linkage, drive, branch = ALL[request.param]
    return linkage, drive, branch, gk.move(linkage, drive, branch, speed=3.0, acceleration=-2.0)


def size(linkage):
    return max(abs(z) for points in linkage.linkage.bodies.values() for z in points.values()) + 1


def test_every_loop_closes_to_rounding(example):
    linkage, _, _, motion = example
    assert motion.assembled.all()
    assert motion.residual.max() < 1e-12 * size(linkage)
    for name, body in motion.bodies.items():
        assert np.abs(np.abs(body.direction) - 1).max() < 1e-14, name


def test_coefficients_are_the_derivatives_of_positions(example):
    linkage, drive, branch, motion = example
    step = 1e-4 * (drive[-1] - drive[0]) / 6
    inner = slice(1, -1)  # the ends may be limits

    def fourth_order(values):
        return (8 * (values[2] - values[1]) - (values[3] - values[0])) / (12 * step)

    around = [gk.move(linkage, drive + k * step, branch) for k in (-2, -1, 1, 2)]
    for name, body in motion.bodies.items():
        for place in (0j, 3 + 4j):
            here, near = body.point(place), [m.bodies[name].point(place) for m in around]
            first, second = fourth_order([p.position for p in near]), fourth_order([p.first for p in near])
            # Rounding of positions over the step is what limits the comparison.
            fuzz = 3e-13 * size(linkage) / step
            assert np.abs(first - here.first)[inner].max() < fuzz
            scale = 1 + np.abs(here.first).max()
            assert np.abs(second - here.second)[inner].max() < 3e-13 * scale * size(linkage) / step
        # The drive runs at 3 and gains -2 per second.
        assert here.velocity == pytest.approx(3 * here.first) and here.acceleration == pytest.approx(
            9 * here.second - 2 * here.first
        )
        turned = np.angle(around[2].bodies[name].direction / around[1].bodies[name].direction) / (2 * step)
        assert np.abs(turned - body.first)[inner].max() < 1e-5 * (1 + np.abs(body.first).max())


WITHOUT_SLIDERS = ["four-bar", "four-bar by rocker", "four-bar by coupler", "four-bar placed elsewhere", "stephenson",
                   "watt", "walking leg", "loops"]  # fmt: skip


@pytest.mark.parametrize("name", [name for name in FEW if name not in WITHOUT_SLIDERS])
def test_sliding_and_coriolis_add_up_to_the_point(name):
    linkage, drive, branch = ALL[name]
    motion = gk.move(linkage, drive, branch, speed=3.0, acceleration=-2.0)
    for slider in linkage.linkage.sliders:
        slide, guide = motion.slide(slider.name), motion.bodies[slider.along]
        line = guide.direction * slider.direction
        point = motion.bodies[slider.body].point(slider.point)
        # The point of the guide that the sliding point covers just now, carried by the guide alone.
        covered = np.conj(guide.direction) * (point.position - guide.origin.position)
        carried = [guide.point(z) for z in covered]
        velocity = np.array([c.velocity[k] for k, c in enumerate(carried)])
        acceleration = np.array([c.acceleration[k] for k, c in enumerate(carried)])
        assert point.velocity == pytest.approx(velocity + slide.velocity * line, abs=1e-9)
        total = acceleration + slide.acceleration * line + slide.coriolis
        assert point.acceleration == pytest.approx(total, abs=1e-8)


def test_loops_by_iteration_agree_with_dyads():
    linkage, drive = locked()
    motion = gk.move(linkage, drive)
    by_dyads = gk.move(gk.Linkage(linkage.bodies, "crank"), np.angle(motion.crank.direction))
    for pin in "ABPD":
        assert np.abs(motion.point(pin).position - by_dyads.point(pin).position).max() < 1e-11
    # The second road for rates: the inverse function.
    assert motion.crank.first == pytest.approx(1 / by_dyads.bodies["out"].first, rel=1e-9)


MANY = {
    "slider-crank": (lambda k: gk.SliderCrank(30 + k, 90 - k, 5 * k, 10 + k * 1j), TURN, 1),
    "slider-crank by coupler": (lambda k: gk.SliderCrank(90 + k, 30 + k, 2 * k, driver="coupler"), TURN, -1),
    "slider-crank by slider": (lambda k: gk.SliderCrank(30 + k, 90, k, driver="slider"), np.linspace(-150, 150, 40), 1),
    "slotted lever": (lambda k: gk.InvertedSliderCrank(80 + k, 30, 5 - k, point=130 + k), TURN, 1),
    "lever that drives": (lambda k: gk.InvertedSliderCrank(80, 30 + k, 5 - k, driver="rocker"), TURN, -1),
    "sliding coupler": (lambda k: gk.InvertedSliderCrank(80 - k, 30, 5 - k, "coupler", point=130j - k), TURN, -1),
    "trammel": (lambda k: gk.EllipticTrammel(60 + k, 100 - k, 80), TURN, 1),
    "trammel by shuttle": (lambda k: gk.EllipticTrammel(60 + k, driver="shuttle"), np.linspace(-70, 70, 40), -1),
    "scotch yoke": (lambda k: gk.ScotchYoke(30 + k, 100 - k, 70), TURN, 1),
    "oldham": (lambda k: gk.OldhamCoupling(6 + k), TURN, 1),
}


@pytest.mark.parametrize("follow", [False, True])
@pytest.mark.parametrize("name", by_default(MANY, slice(0, None, 2)))
def test_batches_equal_single_linkages(name, follow):
    build, drive, branch = MANY[name]
    asked = gk.Continuation(branch) if follow else branch
    steps = np.array([0.0, 1.5, 7.0])
    many = gk.move(build(steps), drive, asked, speed=2.0, acceleration=-3.0)
    assert many.assembled.shape == (len(drive), 3)
    for k, step in enumerate(steps):
        alone = gk.move(build(step), drive, asked, speed=2.0, acceleration=-3.0)
        assert np.array_equal(many.assembled[:, k], alone.assembled) and alone.assembled.any()
        for body in alone.bodies:
            one, other = many.bodies[body], alone.bodies[body]
            assert one.direction[:, k] == pytest.approx(other.direction, abs=1e-13, nan_ok=True)
            assert one.alpha[:, k] == pytest.approx(other.alpha, rel=1e-9, abs=1e-9, nan_ok=True)
            for what in ("position", "velocity", "acceleration"):
                found, known = getattr(one.origin, what)[:, k], getattr(other.origin, what)
                assert found == pytest.approx(known, rel=1e-9, abs=1e-9, nan_ok=True)
        assert many.transmission_angle[:, k] == pytest.approx(alone.transmission_angle, abs=1e-9, nan_ok=True)
        assert np.nan_to_num(many.residual[:, k]).max() < 1e-11


def test_a_pin_in_two_turning_slots_stands_where_they_cross():
    """Each slot by a point and its direction, turned with its body; a block's pin is next to its slot's line."""
    motion = gk.move(crossed_slots(), TURN)
    crank, rocker = motion.crank.direction, motion.rocker.direction
    lines = [
        (crank, motion.crank, 5 - 2j, 20, 35, 3 + 4j - 1j),
        (rocker, motion.rocker, 8 + 1j, -30, 15, -5 + 2j - 2),
    ]
    starts, ways = [], []
    for turn, body, through, way, askew, pin in lines:
        along = turn * np.exp(1j * np.radians(way))
        ways.append(along)
        starts.append(body.point(through).position + along * np.exp(1j * np.radians(askew)) * pin)
    matrices = np.array([[ways[0].real, -ways[1].real], [ways[0].imag, -ways[1].imag]]).transpose(2, 0, 1)
    apart = starts[1] - starts[0]
    slid = np.linalg.solve(matrices, np.stack([apart.real, apart.imag], axis=-1)[..., None])[..., 0, 0]
    assert motion.point("P").position == pytest.approx(starts[0] + slid * ways[0], rel=1e-9)
    assert motion.slide("one").displacement == pytest.approx(slid, rel=1e-9)
    # Only the angle of the guides shows how well conditioned it is.
    between = np.abs(np.imag(np.conj(ways[0]) * ways[1]))
    assert (np.sin(motion.transmission_angle) <= between + 1e-12).all()


def test_an_open_frame_is_nan_in_everything():
    motion = gk.move(gk.StephensonSixBar(FOUR_BAR, 20, 60, 60 + 120j), TURN, speed=2.0)
    away = ~motion.assembled
    assert away.any()
    for name, body in motion.bodies.items():
        if name != "ground":
            assert np.isnan(body.direction[away]).all() and np.isnan(body.omega[away]).all(), name
            assert np.isnan(body.point(1.0).acceleration[away]).all(), name
    assert np.isnan(motion.transmission_angle[away]).all()


class Shifted:
    """A solution with one body moved off, mm, from where its joints want it."""

    def __init__(self, solution, body, by):
        self.solution, self.body, self.by = solution, body, by

    def origin(self, body, order):
        return self.solution.origin(body, order) + (self.by if body == self.body and order == 0 else 0)

    def evaluation_at(self, body, local):
        """Nothing, so that points go by the origin above."""

    def __getattr__(self, name):
        return getattr(self.solution, name)


@pytest.mark.parametrize(
    ("linkage", "body", "by", "residual"),
    [
        (FOUR_BAR, "coupler", 3 + 4j, 5.0),
        (FOUR_BAR, "rocker", -2j, 2.0),
        (gk.ScotchYoke(30, 100, 70), "yoke", 3j, 3.0),
        # Along its rail a slider may stand anywhere, so that only its pins are missed.
        (gk.SliderCrank(30, 90, 12), "slider", 3.0, 3.0),
        (gk.SliderCrank(30, 90, 12), "slider", 4.0 + 3j, 5.0),
        (gk.EllipticTrammel(60, 100, 80), "shuttle", 0.5, 0.5),
    ],
)
def test_residual_is_the_distance_of_a_joint(linkage, body, by, residual):
    motion = gk.move(linkage, TURN)
    off = replace(motion, solution=Shifted(motion.solution, body, by))
    assert off.residual == pytest.approx(np.full(len(TURN), residual), abs=1e-12)


def test_the_residual_of_a_slide_is_the_distance_across_its_line():
    """A body that nothing but slides hold, moved along one of them: the other is missed by what is across it."""
    motion = gk.move(gk.OldhamCoupling(6), TURN)
    disc = next(b for b in motion.linkage.bodies if all(b not in bodies for bodies in motion.linkage.pins.values()))
    slider = motion.linkage.sliders[0]
    ahead = motion.bodies[slider.along].direction * slider.direction
    off = replace(motion, solution=Shifted(motion.solution, disc, 2.0 * ahead))
    assert off.residual == pytest.approx(np.full(len(TURN), 2.0), abs=1e-12)


def test_a_linkage_s_size_is_its_farthest_point_or_line_one_for_each_of_many():
    bodies = {
        "ground": {"O": 0},
        "crank": {"O": 0, "A": np.array([30.0, 3.0])},
        "rod": {"A": 1j, "P": 20j},
        "sled": {"P": 4},
    }

    def size(point=0j, through=0j):
        linkage = gk.Linkage(bodies, "crank", (gk.Slider("slide", "sled", "ground", point, through),))
        assert linkage.is_batch and linkage.shape == (2,)
        return linkage.size.tolist()

    assert size() == [30, 20] and size(25j, -3) == [30, 25] and size(-3, 25j) == [30, 25] and size(0, 40) == [40, 40]
    assert float(gk.FourBar(1, 3, 3.5, 2).linkage.size) == 3.5


# A four-bar whose coupler point moves a rod in a pivoted cylinder: no pin of these two stands before the four-bar does.
CYLINDER = gk.Linkage(
    {
        "ground": {"O": 0, "C": 100, "E": 60 + 150j},
        "crank": {"O": 0, "A": 30},
        "cylinder": {"E": 0},
        "rod": {"P": 0, "end": -90},
        "coupler": {"A": 0, "B": 90, "P": 40 + 25j},
        "rocker": {"C": 0, "B": 70},
    },
    "crank",
    (gk.Slider("stroke", "rod", "cylinder"),),
)
# A shaper with its ram on a rail: a slot, a bar from its end, a slide.
SHAPER = gk.Shaper(90, 30, 180, 60, 85, origin=3j).linkage
# A crank that slides a plate along a moving lever's rail and a fixed one.
YOKE = gk.ScotchYoke(30, 100, 70).linkage


@pytest.mark.parametrize(
    "linkage", by_default([CYLINDER, SHAPER, YOKE], slice(0, 3, 2)), ids=["cylinder", "shaper", "yoke"]
)
def test_orders_of_bodies_and_sliders_give_the_same_motion(linkage):
    drive = np.array([0.7, 2.0])
    before = gk.move(linkage, drive)
    assert before.assembled.all()
    ground, *others = linkage.bodies
    # A few of them: any of the bodies comes first in some.
    for order in list(permutations(others))[::17]:
        bodies = {name: linkage.bodies[name] for name in (ground, *order)}
        for sliders in permutations(linkage.sliders):
            same = gk.Linkage(bodies, linkage.driver, sliders, linkage.origin, linkage.ground_angle_deg)
            assert not any(isinstance(step, Loops) for step in plan(same))
            joints = gk.move(same, drive).branches
            # Which side is left depends on which body comes first: one of the branches is the same motion.
            apart = []
            for signs in product((1, -1), repeat=len(joints)):
                motion = gk.move(same, drive, dict(zip(joints, signs)))
                assert np.nanmax(motion.residual, initial=0.0) < 1e-10
                apart.append(max(np.abs(motion.bodies[b].direction - before.bodies[b].direction).max() for b in bodies))
            assert np.nanmin(apart) < 1e-12, order
