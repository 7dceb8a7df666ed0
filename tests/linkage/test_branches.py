"""Branches: fixed, followed through change points at any step, and the circuit of every frame."""

import math
from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.solve.input_dyads import gap_of

STEPS = [7, 361]


@pytest.mark.parametrize("frames", STEPS)
@pytest.mark.parametrize("lengths", [(2, 3, 2, 3), (1, 1, 1, 1), (0.3, 0.1, 0.1 + 0.2, 0.1)])
@pytest.mark.parametrize("span", [(0.3, 0.3 - 2 * np.pi), (-4 * np.pi, 4 * np.pi)])
def test_a_parallelogram_stays_one_at_any_step(lengths, frames, span):
    motion = gk.move(gk.FourBar(*lengths), np.linspace(*span, frames), "follow")
    if span[0] == -4 * np.pi or span[1] > 0:
        assert motion.assembled.all()
        assert np.abs(motion.coupler.direction - 1).max() < 1e-15 * 8
        assert motion.rocker.first == pytest.approx(np.ones(frames), abs=1e-14)
        assert np.abs(motion.coupler.second).max() < 1e-13
    else:
        assert np.abs(motion.coupler.direction - 1).max() < 1e-15 * 8


def test_fixed_branch_inverts_a_parallelogram_at_its_change_point():
    drive = np.linspace(0.1, 2 * np.pi - 0.1, 50)
    fixed, followed = (gk.move(gk.FourBar(3, 2, 3, 2), drive, b) for b in (1, "follow"))
    assert set(fixed.branches["rocker_pin"]) == {1}
    signs = followed.branches["rocker_pin"]
    assert np.array_equal(signs, np.where(drive < np.pi, 1, -1))
    late = drive > np.pi
    assert np.abs(fixed.coupler.direction[late] - 1).min() > 0.04


def test_a_change_point_with_one_vanishing_gap_takes_two_turns_to_come_back():
    """4 + 1 = 2 + 3, in line once a turn: the other branch after one turn, the first again after two."""
    linkage = gk.FourBar(ground=3, crank=1, coupler=4, rocker=2)
    turns = 0.5 + 2 * np.pi * np.arange(5)
    motion = gk.move(linkage, turns, "follow")
    one, two = motion.rocker.direction[:2]
    assert abs(one - two) > 0.1
    assert motion.rocker.direction == pytest.approx([one, two, one, two, one], abs=1e-14)
    smooth = gk.move(linkage, np.linspace(0.5, 0.5 + 4 * np.pi, 5001), "follow").rocker
    assert np.abs(np.diff(smooth.direction)).max() < 0.02


@pytest.mark.parametrize("frames", STEPS)
def test_an_in_line_slider_crank_of_equal_links_runs_through_its_middle(frames):
    drive = np.linspace(0, 4 * np.pi, frames)
    motion = gk.move(gk.SliderCrank(50, 50), drive, "follow")
    assert motion.assembled.all()
    assert motion.slider.origin.position == pytest.approx(100 * np.cos(drive), abs=2e-13)
    assert motion.coupler.first == pytest.approx(-np.ones(frames), abs=1e-14)


@pytest.mark.parametrize("frames", [6, 182])
def test_a_slider_that_drives_equal_links_carries_them_through_the_middle(frames):
    """No formula continues this one: the branch is kept by the motion itself."""
    drive = np.linspace(90, -90, frames)
    motion = gk.move(gk.SliderCrank(50, 50, driver="slider"), drive, "follow")
    pin = motion.point("crank_pin").position
    assert motion.assembled.all() and pin == pytest.approx(drive / 2 + 1j * np.sqrt(2500 - drive**2 / 4), abs=1e-12)


@pytest.mark.parametrize(
    ("linkage", "count"),
    [
        (gk.FourBar(100, 30, 90, 70), 2),
        (gk.FourBar(30, 100, 90, 70), 2),
        pytest.param(gk.FourBar(100, 70, 90, 30), 2, marks=pytest.mark.campaign),
        pytest.param(gk.FourBar(100, 70, 30, 90), 2, marks=pytest.mark.campaign),
        (gk.FourBar(4, 3, 2, 2.5), 1),
        (gk.SliderCrank(30, 90, 12), 2),
        (gk.SliderCrank(90, 30, 12), 2),
        (gk.SliderCrank(60, 50, 20), 1),
    ],
)
def test_circuits_are_the_connected_sets_of_poses(linkage, count):
    """Poses joined to their neighbours on the same branch, and across a limit to the other: the connected sets."""
    drive = np.linspace(0, 2 * np.pi, 361)[:-1]
    motions = {side: gk.move(linkage, drive, side) for side in (1, -1)}
    label = {(side, k): (side, k) for side in (1, -1) for k in np.flatnonzero(motions[side].assembled)}

    def root(pose):
        while label[pose] != pose:
            pose = label[pose]
        return pose

    for side, k in label:
        after = (k + 1) % len(drive)
        if (side, after) in label:
            label[root((side, k))] = root((side, after))
        elif (-side, k) in label:
            label[root((side, k))] = root((-side, k))
        if (side, (k - 1) % len(drive)) not in label and (-side, k) in label:
            label[root((side, k))] = root((-side, k))
    sets = {root(pose) for pose in label}
    reported = {pose: gk.linkage.circuits(linkage, motions[pose[0]])[pose[1]] for pose in label}
    assert len(sets) == count
    assert len({(root(p), t) for p, t in reported.items()}) == count and 0 not in reported.values()


DECIMALS = {
    "shortest crank": lambda s: gk.FourBar(4 * s, 1 * s, 3 * s, 6 * s),
    "shortest crank, longest ground": lambda s: gk.FourBar(6 * s, 1 * s, 3 * s, 4 * s),
    "shortest crank, longest coupler": lambda s: gk.FourBar(3 * s, 1 * s, 6 * s, 4 * s),
    "shortest ground": lambda s: gk.FourBar(1 * s, 3 * s, 6 * s, 4 * s),
    "shortest coupler": lambda s: gk.FourBar(6 * s, 3 * s, 1 * s, 4 * s),
    "parallelogram": lambda s: gk.FourBar(5 * s, 2 * s, 5 * s, 2 * s),
    "kite": lambda s: gk.FourBar(7 * s, 3 * s, 3 * s, 7 * s),
    "slider-crank": lambda s: gk.SliderCrank(3 * s, 5 * s, 2 * s),
    "slider-crank from above": lambda s: gk.SliderCrank(3 * s, 5 * s, -2 * s),
}


@pytest.mark.parametrize("size", [0.7 / 3, 1e-6 / 7])
@pytest.mark.parametrize("name", DECIMALS)
def test_lengths_that_add_up_but_for_their_rounding_have_a_change_point(name, size):
    drive = np.linspace(0.3, 0.3 + 4 * np.pi, 50)
    whole, rounded = (gk.move(DECIMALS[name](s), drive, "follow") for s in (1.0, size))
    assert np.array_equal(whole.assembled, rounded.assembled)
    assert rounded.coupler.direction == pytest.approx(whole.coupler.direction, abs=1e-13, nan_ok=True)
    # By the fixed branch it is another motion from there on.
    fixed = gk.move(DECIMALS[name](1.0), drive).coupler.direction
    assert np.nanmax(np.abs(fixed - whole.coupler.direction)) > 0.5
    # And so it is where the coupler is really a little longer or shorter: then the branches pass each other.
    given = DECIMALS[name](size)
    near = [gk.move(replace(given, coupler=given.coupler * (1 + k * 1e-9)), drive, "follow") for k in (1, -1)]
    assert min(np.nanmax(np.abs(motion.coupler.direction - fixed)) for motion in near) < 1e-3


def leaning(offset):
    """A slider-crank of crank 3 and rod 5, its slide and its crank's pin turned out of the bodies' axes."""
    rail, arm = np.exp(1j * np.radians(25)), 3 * np.exp(2.5j)
    bodies = {"ground": {"O": 0}, "crank": {"O": 0, "A": arm}, "rod": {"A": 0, "B": 5j}, "sled": {"B": 0}}
    return gk.Linkage(bodies, "crank", (gk.Slider("s", "sled", "ground", 0, 1j * offset * rail, 25),))


FOLLOWED = {name: build(1.0) for name, build in DECIMALS.items()}
FOLLOWED |= {"leaning slide": leaning(2), "leaning slide from above": leaning(-2)}


@pytest.mark.parametrize("start", [1.8])
@pytest.mark.parametrize("name", FOLLOWED)
def test_followed_motion_is_smooth(name, start):
    """From frame to frame it moves by its rates, and these change by theirs."""
    step = 4 * np.pi / 1500
    for way in (1, -1):
        for sign in (1, -1):
            motion = gk.move(FOLLOWED[name], start + way * step * np.arange(1501), gk.Continuation(sign))
            known = motion.assembled[1:] & motion.assembled[:-1]
            signs = motion.branches[next(iter(motion.branches))]
            assert signs[0] in (sign, 0)
            for body in list(motion.bodies.values())[2:]:
                turned = np.angle(body.direction[1:] * np.conj(body.direction[:-1]))
                for gone, rate in ((turned, body.first), (np.diff(body.first), body.second)):
                    fastest = np.maximum(np.abs(rate[1:]), np.abs(rate[:-1]))
                    assert (np.abs(gone) <= 1.2 * step * fastest + 1e-4)[known].all(), (body.name, way, sign)


def test_gap_sums_are_exact():
    """By the standard library's exact sum, of lengths that all but cancel."""
    rng = np.random.default_rng(2)
    for _ in range(200):
        one, two, three = rng.uniform(-1, 1, 3) * 10.0 ** rng.integers(-6, 7, 3)
        terms = one, two, -one * (1 + rng.integers(-3, 4) * 2.0**-52), three * 1e-16, -two
        total, size = math.fsum(terms), sum(map(abs, terms))
        # What is added back is rounded, too: by the square of the rounding.
        assert gap_of(False, *terms) == pytest.approx(total, rel=1e-14, abs=1e-30 * size)
        reported = total if abs(total) > 8 * np.finfo(float).eps * size else 0.0
        assert gap_of(True, *terms) == pytest.approx(reported, rel=1e-14, abs=1e-30 * size)


@pytest.mark.parametrize("sizes", [(30, 42, 12), (30, 42, -12), (42, 30, 12), (42, 30, -12), (30, 30, 0)])
def test_a_slider_crank_that_just_turns_fully_has_one_circuit(sizes):
    """Where link and crank stand across the slide its two sides meet; a little longer or shorter, and they do not."""
    drive = np.linspace(0.05, 6.2, 30)
    for branch in (1, -1):
        motion = gk.move(gk.SliderCrank(*sizes), drive, branch)
        reported = gk.linkage.circuits(gk.SliderCrank(*sizes), motion)
        assert motion.assembled.any() and np.array_equal(reported, motion.assembled.astype(int))
    if sizes[2]:
        longer = gk.SliderCrank(*(size + (0.01 if size == 42 else 0) for size in sizes))
        reported = [gk.linkage.circuits(longer, gk.move(longer, drive, branch)) for branch in (1, -1)]
        assert {*reported[0].tolist(), *reported[1].tolist()} >= {1, -1}
