"""What opens a linkage first, by how much, and what closes it: each advice is taken, and a little less is not enough."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.checks import assembly_error
from tests.linkage.examples import FOUR_BAR, TURN, boom, locked, pushed

TRIPLE_ROCKER = gk.FourBar(4, 3, 2, 2.5)


def test_assembled_motion_has_no_failure():
    assert gk.linkage.assembly_failure(gk.move(FOUR_BAR, TURN)) is None


@pytest.mark.parametrize("scale", [1e-7, 1.0, 1e7])
def test_failure_is_the_first_open_frame(scale):
    drive = np.linspace(0, np.pi, 37)
    motion = gk.move(gk.FourBar(*(scale * np.array([4, 3, 2, 2.5]))), drive)
    found = gk.linkage.assembly_failure(motion)
    apart = abs(4 - 3 * np.exp(1j * drive))
    assert found.frame == np.flatnonzero(apart > 4.5)[0] and found.drive == drive[found.frame]
    assert found.joint == "rocker_pin" and found.lacking == pytest.approx(scale * (apart[found.frame] - 4.5), rel=1e-9)
    assert found.branch is None


OPEN = {
    "stretched": (lambda d: gk.FourBar(4, 3, 2 + d, 2.5), [2.0], 1),
    "folded": (lambda d: gk.FourBar(1.5, 1, 3.9 - d, 1.6), [0.0], 1),
    "slider-crank": (lambda d: gk.SliderCrank(30, 20 + d), [1.5], 1),
    "slider-crank from below": (lambda d: gk.SliderCrank(30, 20 + d), [-1.5], -1),
    "slotted lever": (lambda d: gk.InvertedSliderCrank(40, 30, 25 - d), [0.0], 1),
    "output": (lambda d: gk.StephensonSixBar(FOUR_BAR, 20 + d, 20, 60 + 120j), [1.0], -1),
    "driven by a slider": (lambda d: gk.SliderCrank(30, 90 + d, driver="slider"), [200.0], 1),
    "ram of a lever": (lambda d: gk.Shaper(90, 30, 180, 20 + d, 120), [1.2], 1),
    "ram above": (lambda d: gk.Shaper(90, 30, 180, 5 + d, 60), [0.0], 1),
}


@pytest.mark.parametrize("name", OPEN)
def test_suggested_length_assembles_and_a_smaller_one_does_not(name):
    build, drive, branch = OPEN[name]
    found = gk.linkage.assembly_failure(gk.move(build(0.0), drive, branch))
    advised = float(re.search(r"at least ([\d.e+-]+) mm", found.remedy)[1])
    assert gk.move(build(advised), drive, branch).assembled.all()
    assert not gk.move(build(0.998 * advised), drive, branch).assembled.any()
    assert found.lacking <= advised <= 1.001 * found.lacking


@pytest.mark.parametrize(("build", "stroke"), [(boom, 1.0), (boom, 500.0), (pushed, 1.0)])
def test_suggested_stroke_assembles(build, stroke):
    found = gk.linkage.assembly_failure(gk.move(build(), [stroke]))
    advised = float(re.search(r"at least ([\d.e+-]+) mm", found.remedy)[1])
    way = -1 if "shorter" in found.remedy else 1
    # The reported length is of the actuator; its stroke changes it by less where it is bent.
    closed = [gk.move(build(), [stroke + way * share * advised]).assembled[0] for share in (0.9, 1.0, 1.1)]
    assert not closed[0] and closed[2]


def test_suggested_drives_assemble():
    for linkage, drive in (
        (TRIPLE_ROCKER, np.linspace(2, 4, 9)),
        (gk.SliderCrank(30, 90, driver="slider"), [200.0, 230.0]),
    ):
        refusal = assembly_error(gk.move(linkage, drive))
        assert refusal.field == "drive"
        turns = refusal.remedy.split()[-4] != "mm," and "deg" in refusal.remedy
        for low, high in re.findall(r"(-?[\d.]+) and (-?[\d.]+) (?:deg|mm)", refusal.remedy):
            ends = np.array([float(low), float(high)])
            inside = np.linspace(*ends, 50)
            beyond = ends + np.array([-0.02, 0.02]) * np.ptp(ends)
            assert gk.move(linkage, np.radians(inside) if turns else inside).assembled.all()
            assert not gk.move(linkage, np.radians(beyond) if turns else beyond).assembled.any()


def test_guides_that_stand_parallel_and_loops_are_named_without_a_length():
    tangent = gk.Linkage(
        {"ground": {"O": 0}, "crank": {"O": 0}, "block": {"P": 0}, "yoke": {"P": 0}},
        "crank",
        sliders=(gk.Slider("radial", "block", "crank"), gk.Slider("way", "yoke", "ground", through=5j)),
    )
    found = gk.linkage.assembly_failure(gk.move(tangent, [1.0, 0.5, 0.0]))
    assert found.frame == 2 and found.joint == "block" and np.isnan(found.lacking)
    linkage, drive = locked()
    motion = gk.move(linkage, np.linspace(drive[0], drive[0] + 3, 200))
    found = gk.linkage.assembly_failure(motion)
    assert np.isnan(found.lacking) and "crank" in found.joint and found.branch is None
    assert found.frame == np.argmin(motion.assembled) > 0


def test_the_least_transmission_angle_is_that_of_the_frames_reached():
    drive = np.linspace(0.5, 3.0, 60)
    motion = gk.move(TRIPLE_ROCKER, drive)
    # Cosine rule at the rocker pin, against the diagonal from the crank pin to the rocker's pivot.
    square = np.abs(4 - 3 * np.exp(1j * drive)) ** 2
    inside = square < 4.5**2
    at_pin = np.arccos((2**2 + 2.5**2 - square[inside]) / (2 * 2 * 2.5))
    least = np.minimum(at_pin, np.pi - at_pin).min()
    assert 0 < inside.sum() < 60 and gk.least_transmission_angle(motion) == pytest.approx(least, rel=1e-9)
    assert np.isnan(gk.least_transmission_angle(gk.move(TRIPLE_ROCKER, [2.5, 3.0])))
    many = gk.move(gk.FourBar(4, 3, 2, np.array([2.5, 0.1, 2.6])), drive)
    assert gk.least_transmission_angle(many).shape == (3,)
    assert gk.least_transmission_angle(many)[0] == gk.least_transmission_angle(motion)


def test_many_linkages_are_refused_by_their_number():
    motion = gk.move(gk.FourBar(100, np.array([30.0, 31.0, 32.0]), 50, 55), np.linspace(0, 6, 5))
    with pytest.raises(gk.DesignError) as caught:
        gk.linkage.assembly_failure(motion)
    assert caught.value.field == "motion"


def chained(rng):
    """A four-bar, a dyad on its coupler and one on that dyad's output, of sizes with which they often do not close."""
    bodies = {
        "ground": {"O": 0, "C": 100, "E": 60 + 120j, "G": -60 + 150j},
        "crank": {"O": 0, "A": 30},
        "coupler": {"A": 0, "B": 90, "P": complex(*rng.uniform(-40, 60, 2))},
        "rocker": {"C": 0, "B": 70},
        "rod": {"P": 0, "D": rng.uniform(50, 110)},
        "output": {"E": 0, "D": 60, "Q": complex(*rng.uniform(-70, 70, 2))},
        "bar": {"Q": 0, "F": rng.uniform(60, 120)},
        "last": {"G": 0, "F": rng.uniform(40, 80)},
    }
    return gk.Linkage(bodies, "crank")


def test_suggested_branch_is_the_best_of_all():
    """By moving on every choice of the signs before: closed at that frame, at most others, with the fewest changes."""
    rng, counts = np.random.default_rng(2), {True: 0, False: 0, "elsewhere": 0, "later": 0}
    for _ in range(120):
        linkage, drive = chained(rng), np.linspace(0, 6, 25) + rng.uniform(0, 6)
        asked = {joint: int(rng.choice([1, -1])) for joint in "BDF"}
        found = gk.linkage.assembly_failure(gk.move(linkage, drive, asked))
        if found is None:
            continue
        joints = "BDF"[: "BDF".index(found.joint)]
        choices = []
        for flips in range(1, 2 ** len(joints)):
            signs = asked | {joint: -asked[joint] for k, joint in enumerate(joints) if flips >> k & 1}
            closed = gk.move(linkage, drive, signs).assembled
            choices.append((closed[found.frame], closed.mean(), -flips.bit_count(), signs))
        there = [choice[1:] for choice in choices if choice[0]]
        counts[bool(there)] += 1
        counts["elsewhere"] += max([c[1] for c in choices if not c[0]], default=0) > max(
            [c[0] for c in there], default=0
        )
        counts["later"] += found.frame > 0 and bool(there)
        assert (found.branch is None) == (not there)
        if there:
            best = max(choice[:2] for choice in there)
            assert found.branch in [signs for *rank, signs in there if tuple(rank) == best]
    assert min(counts.values()) >= 3, counts
