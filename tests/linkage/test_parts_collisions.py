"""Which pairs of plates and pins meet: against the exact look pair by pair, and against shapely at finer frames."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import geomkin as gk
from geomkin.linkage.parts import collisions as near
from geomkin.linkage.parts.collisions import Pair, meeting, relative_paths
from geomkin.linkage.parts.layers import Meetings
from geomkin.linkage.parts.plates import assemble
from geomkin.linkage.parts.stock import LinkStock
from geomkin.plane.primitives import convex_hull
from tests.campaign import by_default
from tests.linkage.mechanisms import BUILDABLE, TURN

QUARTERS = np.radians(np.arange(0, 360.1, 0.25))
LEG = BUILDABLE["jansen leg"][:2]
# Closes at some of its frames only.
OPEN = gk.FourBar(100, 70, 30, 90), 1


def gaps(motion, pair):
    return relative_paths(motion, pair.body, pair.other, pair.places).gap(pair.corners)


def pairs_at_random(motion, seed, count=40):
    random, bodies = np.random.default_rng(seed), list(motion.bodies)
    for _ in range(count):
        a, b = (random.normal(0, 30, k) + 1j * random.normal(0, 30, k) for k in random.choice([1, 1, 2, 2, 3, 5], 2))
        one, two = random.choice(bodies, 2, replace=False)
        corners, places = (np.array(convex_hull(z)) for z in (a, b))
        yield Pair(str(one), corners, str(two), places, float(random.uniform(0.1, 40)))


def moved(pair, near):
    return Pair(pair.body, pair.corners, pair.other, pair.places, near)


@pytest.mark.parametrize(("linkage", "step_deg"), [(LEG, 7.0), (OPEN, 1.0)], ids=["leg", "open"])
def test_pairs_meet_where_the_exact_look_at_each_says_so(linkage, step_deg):
    """Also where they all but meet: at distances that differ from the least gap by rounding."""
    motion = gk.move(linkage[0], np.radians(np.arange(0, 360 + step_deg, step_deg)), linkage[1])
    pairs = list(pairs_at_random(motion, 1, 40))
    pairs += list(only_just(motion, pairs))
    wanted = [bool((gaps(motion, pair) < pair.near).any()) for pair in pairs]
    assert 0.2 < np.mean(wanted) < 0.9
    assert meeting(motion, pairs).tolist() == wanted


def only_just(motion, pairs):
    """The same pairs, each at distances at which it only just meets, or does not."""
    least = [float(gaps(motion, pair).min()) for pair in pairs]
    for share in (-1e-6, -1e-11, 1e-11, 1e-6):
        yield from (moved(pair, gap + share * 30) for pair, gap in zip(pairs, least) if gap > 1e-3)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 50), st.sampled_from([64, 1 << 15]))
def test_nor_do_uneven_frames_or_how_many_are_looked_at_at_once_change_it(seed, frames, at_once):
    """Frames that crowd together and lie far apart, closed and open ones in turns."""
    random = np.random.default_rng(seed)
    drive = random.uniform(0, 7) + 3 * np.sort(random.uniform(-1, 1, frames) ** random.choice([1, 3, 9]))
    linkage = [OPEN[0], gk.FourBar(100, 30, 90, 70)][seed % 2]
    motion = gk.move(linkage, drive)
    pairs = list(pairs_at_random(motion, seed, 5))
    # The crank's own pivot, which stands still.
    pairs.append(Pair("ground", np.array([-40 - 9j, -5 - 9j]), "crank", np.array([0j]), 10.0))
    if motion.assembled.any():
        pairs += list(only_just(motion, pairs))
    wanted = [bool((gaps(motion, pair) < pair.near).any()) for pair in pairs]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(near, "AT_ONCE", at_once)
        assert meeting(motion, pairs).tolist() == wanted


def test_a_step_that_turns_round_may_come_nearest_though_its_ends_do_not():
    """A slider at the same place before and after its dead centre, at the first step of those about one frame."""
    start = near.EVERY
    drive = [*np.linspace(-2, -0.5, start), -0.3, *(0.3 + 1e-6 * np.arange(start))]
    motion = gk.move(gk.SliderCrank(30, 90), np.array(drive))
    pair = Pair("ground", np.array([150 + 0j]), "slider", np.array([0j]), 1.0)
    assert gaps(motion, pair).argmin() == start
    pairs = list(only_just(motion, [pair]))
    assert meeting(motion, pairs).tolist() == [False, False, True, True]


@pytest.mark.parametrize("name", by_default(["whitworth", "jansen leg", "ram with a tool"], ["whitworth"]))
def test_every_pair_of_a_mechanism_is_as_shapely_sees_it_in_quarter_degrees(name):
    linkage, branch, *_ = BUILDABLE[name]
    stock, motion, fine = LinkStock(), gk.move(linkage, TURN, branch), gk.move(linkage, QUARTERS, branch)
    meetings = Meetings(motion, stock, assemble(motion, stock))
    joined = {frozenset(p) for pin in meetings.assembly.pins for p in [(a, b) for a in pin.plates for b in pin.plates]}
    of, moving = meetings.assembly.plates, meetings.moving

    def least(a, b):
        """Of two shapes that two bodies carry, each given by its body and centres, over all fine frames, mm."""
        shapes = []
        for body, centres in (a, b):
            pose = fine.bodies[body]
            world = pose.origin.position[:, None] + pose.direction[:, None] * centres
            shapes.append(shapely.convex_hull(shapely.multipoints([gk.plane.xy(z) for z in world])))
        return shapely.distance(*shapes).min()

    for k, one in enumerate(moving):
        for two in moving[:k]:
            if frozenset((one, two)) not in joined:
                apart = least((of[one].body, of[one].centres), (of[two].body, of[two].centres)) - stock.bar_width
                assert_reported(frozenset((one, two)) in meetings.plates, apart, meetings.play)
    for pin in meetings.assembly.pins:
        for plate in moving:
            if plate not in pin.plates:
                apart = least((of[plate].body, of[plate].centres), (pin.body, np.array([pin.place])))
                apart -= (stock.bar_width + stock.pin_diameter) / 2
                assert_reported((pin.name, plate) in meetings.pin_and_plate, apart, meetings.play)


def assert_reported(meets, apart, play):
    """What comes nearer meets; what stays away by more than half of what a corner goes on a step does not."""
    assert meets or apart >= play
    assert not meets or apart < play + 1.0
