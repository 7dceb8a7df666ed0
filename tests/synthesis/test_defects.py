"""The exact rule of defects, against linkages driven in small steps."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.guidance.guides import FourBars, SliderCranks, Trammels, four_bar_defects, slider_crank_defects
from tests.campaign import by_default
from tests.synthesis import driving

# Nearer to a border than this, rounding decides, in the rule as in the steps.
BORDER = 1e-9


def cases(kind, count, seed):
    """Linkages of a kind through random places: guides, and the same to be driven in steps."""
    rng = np.random.default_rng(seed)
    if kind.startswith("random"):
        _, places, driver = kind.split()
        first, second, pivots = driving.random_linkages(rng, count, int(places), driver)
        if driver == "rocker":
            return FourBars(first=second, second=first, pivots=pivots[::-1]), driving.of_four_bar(
                first, second, pivots, "rocker"
            )
        return FourBars(first=first, second=second, pivots=pivots), driving.of_four_bar(first, second, pivots, "crank")
    poses = driving.three_poses(rng, count)
    pins = driving.carried(poses, rng.normal(size=count) + 1j * rng.normal(size=count))
    other = driving.carried(poses, rng.normal(size=count) + 1j * rng.normal(size=count))
    if kind == "four-bar":
        pivots = driving.centre_of(pins), driving.centre_of(other)
        return FourBars(first=pins, second=other, pivots=pivots), driving.of_four_bar(pins, other, pivots, "crank")
    slid, rail = driving.sliding(poses, rng)
    keep = np.isfinite(slid).all(axis=0)
    pins, slid, rail = pins[:, keep], slid[:, keep], rail[keep]
    if kind in ("crank-slider", "slider-crank"):
        pivot, driver = driving.centre_of(pins), "crank" if kind == "crank-slider" else "slider"
        guides = SliderCranks(first=pins, second=slid, pivot=pivot, rail=rail, slides=driver == "slider")
        return guides, driving.of_slider_crank(pins, slid, pivot, rail, driver)
    again, slot = driving.sliding((poses[0][:, keep], poses[1][:, keep]), rng)
    keep = np.isfinite(again).all(axis=0)
    again, slot, slid, rail = again[:, keep], slot[keep], slid[:, keep], rail[keep]
    guides = Trammels(first=again, second=slid, slots=(slot, rail), slides=kind == "shuttle")
    return guides, driving.of_trammel(again, slid, (slot, rail), "shuttle" if kind == "shuttle" else "rod")


def compared(kind, count, seed):
    """How many were distinguished by rounding alone, how many are sound, and how many verdicts differ."""
    guides, case = cases(kind, count, seed)
    found = guides.defects
    near = ~(found.margin > BORDER)
    went = driving.goes_through(case)
    wrong = (went != found.none) & ~near
    return near.sum(), found.none.sum(), wrong.sum(), len(near)


KINDS = (
    "four-bar",
    "crank-slider",
    "slider-crank",
    "rod",
    "shuttle",
    "random 3 crank",
    "random 4 crank",
    "random 4 rocker",
)


@pytest.mark.parametrize("kind", by_default(KINDS, slice(0, None, 2)))
def test_the_rule_agrees_with_driving_in_small_steps(kind):
    near, sound, wrong, count = compared(kind, 2000, 1)
    assert wrong == 0 and near <= 2 and 0.02 * count < sound and (kind == "rod" or sound < 0.98 * count)


def signs_at(sizes, directions, joint):
    """Signs of the angle at a joint, by the two links that meet there."""
    crank, coupler, rocker = directions
    one, two = {
        "rocker_pin": (coupler, rocker),
        "crank_pivot": (np.ones_like(crank), crank),
        "crank_pin": (crank, coupler),
    }[joint]
    return np.sign((np.conj(one) * two).imag)


def test_circuits_are_those_of_a_joint_that_is_not_at_the_shortest_link():
    """Of a Grashof four-bar; any other has one circuit (Chase and Mirth 1993)."""
    joints = ("rocker_pin", "rocker_pin", "crank_pivot", "crank_pin")
    first, second, pivots = driving.random_linkages(np.random.default_rng(9), 3000, 4, "crank")
    sizes = np.array(
        [
            np.abs(pivots[1] - pivots[0]),
            np.abs(first[0]),
            np.abs(second[0] - first[0]),
            np.abs(second[0] - pivots[1]),
        ]
    )
    ways = [first / sizes[1], (second - first) / sizes[2], (second - pivots[1]) / sizes[3]]
    found = four_bar_defects(*sizes, tuple(ways))
    spare = sizes.sum(axis=0) - 2 * sizes.min(axis=0) - 2 * sizes.max(axis=0)
    signs = np.array([signs_at(sizes, ways, joint) for joint in joints])
    reported = np.take_along_axis(signs, sizes.argmin(axis=0)[None, None], axis=0)[0]
    assert (found.circuit == ((reported != reported[0]).any(axis=0) & (spare > 0))).all() and found.circuit.any()
    # And which branch: the joint opposite the driver, of places that are on one circuit.
    side = signs_at(sizes, ways, "rocker_pin")
    one = ~found.circuit
    assert (found.branch[one] == (side != side[0]).any(axis=0)[one]).all() and found.branch.any()


def at_places(linkage, places):
    """Defects of a four-bar at drives and branches, deg and 1 or -1."""
    moved = [gk.move(linkage, np.radians([q]), sign) for q, sign in places]
    ways = tuple(np.array([m.bodies[name].direction for m in moved]) for name in ("crank", "coupler", "rocker"))
    sizes = [np.array([size]) for size in (linkage.ground, linkage.crank, linkage.coupler, linkage.rocker)]
    return four_bar_defects(*sizes, ways).named(0)


@pytest.mark.parametrize(
    ("sizes", "places", "defects"),
    [
        # A parallelogram keeps its sides apart from 0 to 180 deg; at these it may turn over, or not.
        ((80, 30, 80, 30), [(20, 1), (90, 1), (160, 1)], ()),
        ((80, 30, 80, 30), [(160, 1), (90, 1), (20, 1)], ()),
        ((80, 30, 80, 30), [(20, 1), (160, 1), (90, 1)], ("order",)),
        ((80, 30, 80, 30), [(60, 1), (120, 1), (-60, -1)], ("branch",)),
        # The same sign on both sides: from a parallelogram to a crossed one.
        ((80, 30, 80, 30), [(60, 1), (120, 1), (-60, 1)], ("branch",)),
        ((80, 30, 80, 30), [(60, 1), (120, -1)], ("branch",)),
        # A change point with the driver stretched over the ground, another with it folded.
        ((100, 40, 80, 60), [(-90, 1), (0, 1), (90, 1)], ()),
        ((100, 40, 80, 60), [(90, 1), (150, 1), (-150, 1)], ("order",)),
        ((60, 80, 40, 100), [(90, 1), (120, 1), (170, 1)], ()),
        ((60, 80, 40, 100), [(90, 1), (120, 1), (-90, 1)], ("branch",)),
        # A triple rocker and a crank-rocker, either side.
        ((110, 65, 80, 75), [(-60, 1), (0, 1), (60, 1)], ()),
        ((110, 65, 80, 75), [(-60, 1), (60, 1), (0, 1)], ("order",)),
        ((110, 65, 80, 75), [(-60, 1), (0, -1)], ("branch",)),
        ((100, 30, 90, 70), [(0, 1), (120, 1), (240, 1), (350, 1)], ()),
        ((100, 30, 90, 70), [(350, 1), (240, 1), (120, 1), (0, 1)], ()),
        ((100, 30, 90, 70), [(0, 1), (240, 1), (120, 1), (350, 1)], ("order",)),
        ((100, 30, 90, 70), [(0, 1), (120, -1), (240, 1)], ("circuit",)),
        # A double rocker whose coupler turns: its crank has two ranges.
        ((100, 80, 30, 90), [(40, 1), (60, 1)], ()),
        ((100, 80, 30, 90), [(40, 1), (60, -1)], ("branch",)),
        ((100, 80, 30, 90), [(40, 1), (-40, 1)], ("circuit",)),
        ((100, 80, 30, 90), [(40, 1), (60, -1), (-40, 1)], ("circuit", "branch")),
    ],
)
def test_defects_of_linkages_that_anyone_can_follow(sizes, places, defects):
    assert at_places(gk.FourBar(*sizes), places) == defects


@pytest.mark.campaign
@pytest.mark.parametrize("kind", KINDS)
def test_the_rule_agrees_in_every_one_of_many_cases(kind):
    reported = np.sum([compared(kind, 2500, seed)[:3] for seed in range(100, 108)], axis=0)
    assert reported[2] == 0 and reported[0] <= 20


@pytest.mark.parametrize("lengths", [(100, 30, 120, 50 + 1e-4), (100, 30, 60, 70 + 1e-4)], ids=["folded", "stretched"])
def test_distance_to_either_limit_is_reported(lengths):
    """A ten-thousandth of a millimetre from a change point, folded or stretched, and far from the other one."""
    ground, crank, coupler, rocker = lengths
    motion = gk.move(gk.FourBar(*lengths), np.radians([40.0, 60, 80]))
    ways = tuple(body.direction[:, None] for body in (motion.crank, motion.coupler, motion.rocker))
    found = four_bar_defects(*(np.array([float(v)]) for v in (ground, crank, coupler, rocker)), ways)
    assert found.margin[0] == pytest.approx(1e-4 / sum(lengths), rel=1e-6)


@pytest.mark.parametrize(
    ("lengths", "driver"),
    [
        ((30, 42 + 1e-4, 12), "slider"),
        ((42, 30 + 1e-4, -12), "slider"),
        ((30, 42 + 1e-4, -12), "crank"),
        ((30, 42 + 1e-4, 12), "crank"),
    ],
)
def test_distance_to_the_limit_of_a_slide_is_reported(lengths, driver):
    """A ten-thousandth of a millimetre from where the ways of a slider, or of a crank, meet."""
    crank, coupler, offset = lengths
    known = gk.SliderCrank(crank, coupler, offset)
    motion = gk.move(known, np.radians([100.0, 110, 125] if crank == 30 and driver == "slider" else [-10.0, 5, 15]))
    ways = tuple(body.direction[:, None] for body in (motion.crank, motion.coupler))
    slide = motion.slider.origin.position.real[:, None]
    found = slider_crank_defects(*(np.array([float(v)]) for v in lengths), ways, slide, driver)
    near = abs(abs(crank - coupler) - abs(offset)) if driver == "slider" else coupler - crank - abs(offset)
    assert abs(near) == pytest.approx(1e-4)
    assert found.margin[0] == pytest.approx(1e-4 / (crank + coupler + abs(offset)), rel=1e-6)
