"""Branches followed by the motion itself: past near misses, through change points, from any start, at any step."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.solve import branch
from tests.linkage.examples import FOUR_BAR, TURN, locked
from tests.linkage.near_misses import by_brute_force, near_misses


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.campaign) for k in range(1, 8))])
@pytest.mark.parametrize("side", [1, -1])
def test_near_misses_agree_with_brute_force(seed, side):
    """Six-bars whose output dyad comes within 1e-2 to 1e-11 of being in line, and never is."""
    for six_bar, middle, gap in near_misses(10, seed):
        drive, track = by_brute_force(six_bar, middle, gap, side)
        away = np.flatnonzero(np.abs(drive - middle) > 0.02)[:: 97 + seed]
        motion = gk.move(six_bar, drive[away], gk.Continuation({"output_pin": side}))
        assert motion.assembled.all() and set(motion.branches["output_pin"]) == {side}
        size = six_bar.link + six_bar.output
        assert np.abs(motion.point("output_pin").position - track[away]).max() < 1e-6 * size


@pytest.mark.parametrize("offset", [1e-2, 1e-9])
@pytest.mark.parametrize("rod", [50, 50 - 1e-7])
def test_a_driving_slider_that_hardly_misses_the_crank_s_pivot_keeps_its_side(offset, rod):
    """The crank whips round by half a turn, as it does in steps a thousandth of the miss."""
    drive = np.linspace(80, -80, 33)
    linkage = gk.SliderCrank(50, rod, offset=offset, driver="slider")
    motion = gk.move(linkage, drive, "follow")
    closed = motion.assembled
    assert closed.sum() >= 32 and set(motion.branches["crank_pin"][closed]) == {motion.branches["crank_pin"][0]}
    assert np.abs(motion.crank.direction[-1] - motion.crank.direction[0]) > 0.5


def chain(count):
    """Parallelograms, each driven by the rocker of the one before it, with the places of their pins at drive 0.4."""
    arm, crank = 15 + 5j, np.exp(0.4j)
    ground = {"O": 0, "C": 30}
    bodies = {"crank": {"O": 0, "A": 20}, "coupler": {"A": 0, "B": 30}, "rocker": {"C": 0, "B": 20}}
    pins, before = {"B": 30 + 20 * crank}, "rocker"
    for k in range(count):
        ground[f"E{k}"] = 60 + 30 * k
        bodies[before][f"R{k}"] = arm
        bodies |= {f"rod{k}": {f"R{k}": 0, f"Q{k}": 30}, f"out{k}": {f"E{k}": 0, f"Q{k}": arm}}
        pins[f"Q{k}"] = 60 + 30 * k + arm * crank
        before = f"out{k}"
    return gk.Linkage({"ground": ground, **bodies}, "crank"), pins


@pytest.mark.parametrize("frames", [5, 361])
@pytest.mark.parametrize("turn", [2 * np.pi, -4 * np.pi])
def test_a_chain_of_parallelograms_stays_one_from_given_pins(frames, turn):
    linkage, pins = chain(3)
    drive = np.linspace(0.4, 0.4 + turn, frames)
    motion = gk.move(linkage, drive, gk.Continuation({name: place + 3 - 2j for name, place in pins.items()}))
    assert motion.assembled.all()
    for k in range(3):
        assert np.abs(motion.bodies[f"rod{k}"].direction - 1).max() < 1e-11


def test_a_change_point_is_reached_and_left_at_the_frame_itself():
    """At the very change point rounding must not open the linkage, nor choose a branch there."""
    for turned in np.linspace(0, 6, 25):
        linkage, pins = chain(1)
        placed = gk.Linkage(linkage.bodies, "crank", ground_angle_deg=float(np.degrees(turned)))
        start = {name: place * np.exp(1j * turned) for name, place in pins.items()}
        # The second parallelogram is in line where its crank points along its ground line.
        line = np.angle(15 + 5j)
        drive = np.array([0.4, np.pi - line, np.pi - line + 1e-9, 4.0, 2 * np.pi - line, 7.0])
        motion = gk.move(placed, drive, gk.Continuation(start))
        assert motion.assembled.all()
        ahead = np.exp(1j * turned)
        assert np.abs(motion.bodies["rod0"].direction - ahead).max() < 1e-7


def test_limits_of_a_followed_branch_are_followed_from_the_start_of_the_span():
    """Just before a change point, behind which +1 is what the parallelogram turns inside out to."""
    linkage, pins = chain(1)
    ground = {**linkage.bodies["ground"], "F": 60 + 20j}
    bodies = {**linkage.bodies, "ground": ground, "rod": {"Q0": 0, "S": 12}, "last": {"F": 0, "S": 26}}
    wide = gk.Linkage(bodies, "crank")
    start = 2 * np.pi - np.angle(15 + 5j) - 1e-3
    signs = {joint: int(row[-1]) for joint, row in gk.move(wide, [0.4, start], gk.Continuation(pins)).branches.items()}
    branch = gk.Continuation(signs | {"S": 1})
    parts = gk.driver_limits(wide, branch, (start, start + 2 * np.pi))
    looks = np.linspace(start, start + 2 * np.pi, 2001)
    closed = gk.move(wide, looks, branch).assembled
    inside = np.any([(low <= looks) & (looks <= high) for low, high in parts], axis=0)
    assert 0 < closed.mean() < 1 and np.mean(inside != closed) < 2e-3


def test_a_change_point_stands_where_it_is_to_a_tenth_of_a_millionth_of_a_degree():
    """There the gap is flat: the place of its least value alone is known a hundred times less well."""
    beside = np.geomspace(3e-10, 1e-6, 60)
    for turned in range(0, 360, 45):
        linkage, pins = chain(2)
        placed = gk.Linkage(linkage.bodies, "crank", ground_angle_deg=turned)
        start = {name: place * np.exp(1j * np.radians(turned)) for name, place in pins.items()}
        at = np.pi - np.angle(15 + 5j)
        motion = gk.move(placed, np.concatenate([[0.4], at - beside, at + beside]), gk.Continuation(start))
        for joint in ("Q0", "Q1"):
            assert motion.branches[joint][1:61].min() >= 0 and motion.branches[joint][61:].max() <= 0


def test_a_change_point_within_a_whip_is_passed():
    """A crank that a slide whips round by half a turn within 1e-3 mm, and a parallelogram in line amid that."""
    linkage = gk.SliderCrank(50, 50, offset=1e-4, driver="slider").linkage
    bodies = {name: dict(points) for name, points in linkage.bodies.items()}
    pivot = next(p for p in bodies["crank"] if p in bodies["ground"])
    bodies["crank"]["R"] = bodies["crank"][pivot] + 20
    bodies["ground"]["E"] = 70
    bodies |= {"rod": {"R": 0, "Q": 70}, "out": {"E": 0, "Q": 20}}
    twin = gk.Linkage(bodies, linkage.driver, linkage.sliders)
    for way in (1, -1):
        drive = way * np.linspace(70, -61.3, 29)
        crank = gk.move(linkage, drive, "follow").crank.direction
        pins = {"Q": 70 + 20 * crank[0]}
        motion = gk.move(twin, drive, gk.Continuation(pins))
        assert motion.assembled.all() and len(set(motion.branches["Q"])) == 2
        assert np.abs(crank[-1] - crank[0]) > 0.5
        assert np.abs(motion.out.direction - motion.crank.direction).max() < 1e-6


def test_branch_point_applies_at_the_first_assembled_frame():
    """Past a change point that lies between an open first frame and the first one that closes."""
    bars = gk.FourBar(4, 3, 2, 2.5)
    arm = np.conj(gk.move(bars, [1.0]).rocker.direction[0])
    bodies = {name: dict(points) for name, points in bars.linkage.bodies.items()}
    pivot = next(p for p in bodies["rocker"] if p in bodies["ground"])
    bodies["rocker"]["R"] = bodies["rocker"][pivot] + arm
    bodies["ground"]["E"] = bodies["ground"][pivot] + 3
    bodies |= {"rod": {"R": 0, "Q": 3}, "out": {"E": 0, "Q": 1}}
    linkage = gk.Linkage(bodies, "crank")
    drive = np.array([3.0, 0.5, 0.8, 1.2, 1.3])
    rocker = gk.move(bars, drive).rocker.direction
    motion = gk.move(linkage, drive, gk.Continuation({"Q": bodies["ground"]["E"] + arm * rocker[1]}))
    assert motion.assembled.tolist() == [False, True, True, True, True]
    assert motion.rod.direction[1:] == pytest.approx(np.ones(4), abs=1e-9)


def test_dead_centres_of_a_followed_branch_are_followed_from_the_start_of_the_span():
    """A rocker behind a parallelogram, which is a four-bar of its own as long as that stays one."""
    linkage, pins = chain(1)
    bodies = dict(linkage.bodies)
    bodies["ground"] = {**bodies["ground"], "F": 105}
    bodies |= {"link": {"Q0": 0, "S": 40}, "rocker two": {"F": 0, "S": 35}}
    found = gk.linkage.dead_centres(
        gk.Linkage(bodies, "crank"), "rocker two", gk.Continuation(pins), (0.4, 0.4 + 2 * np.pi)
    )
    lean = np.angle(15 + 5j)
    alone = gk.FourBar(45, abs(15 + 5j), 40, 35)
    wanted = gk.linkage.dead_centres(alone, "rocker", 1, (0.4 + lean, 0.4 + lean + 2 * np.pi)) - lean
    assert len(wanted) == 2 and found == pytest.approx(wanted, abs=1e-9)


def test_start_at_a_change_point_takes_the_branch_it_leaves_on():
    linkage, _ = chain(1)
    start = np.pi - np.angle(15 + 5j)
    for turn in (1.0, -1.0):
        signs = [
            gk.move(linkage, start + turn * t, "follow").branches["Q0"] for t in (np.linspace(0, 1, 4), np.arange(2))
        ]
        assert set(signs[0][1:]) == {1} and signs[1][1] == 1


def test_many_linkages_are_followed_as_each_is_alone():
    linkage, pins = chain(2)
    lengths = np.array([30, 30 + 1e-9, 30.1, 29.5, 30 - 1e-6])
    drive = np.linspace(0.4, 0.4 + 4 * np.pi, 60)

    def moved(length):
        return gk.move(
            gk.Linkage({**linkage.bodies, "rod1": {"R1": 0, "Q1": length}}, "crank"), drive, gk.Continuation(pins)
        )

    many = moved(lengths)
    for k, length in enumerate(lengths):
        one = moved(length)
        assert np.array_equal(many.branches["Q1"][:, k], one.branches["Q1"])
        assert np.array_equal(many.bodies["out1"].direction[:, k], one.bodies["out1"].direction, equal_nan=True)


def test_a_large_one_among_small_ones_is_followed_over_its_whole_stroke():
    """A piston turns a crank, and that another by a parallelogram: in line where the crank points along the slide."""

    def moved(size, drive):
        bodies = {
            "ground": {"O": 0, "C": 100 * size},
            "crank": {"O": 0, "A": 30 * size, "D": 20 * size},
            "rod": {"A": 0, "S": 90 * size},
            "piston": {"S": 0},
            "coupler": {"D": 0, "E": 100 * size},
            "rocker": {"C": 0, "E": 20 * size},
        }
        slide = gk.Slider("slide", "piston", "ground", through=960j)
        return gk.move(gk.Linkage(bodies, "piston", (slide,)), drive, gk.Continuation({"A": -1, "E": -1}))

    sizes, drive = np.array([1.0, 80.0]), np.linspace(9500, 9550, 30)
    many, alone = moved(sizes, drive), moved(80.0, drive)
    assert not many.assembled[:, 0].any() and alone.assembled.all()
    crank, rocker = alone.crank.direction, alone.rocker.direction
    assert np.ptp(np.sign(crank.imag)) == 2 and np.abs(crank - rocker).max() < 1e-6
    assert np.abs(many.rocker.direction[:, 1] - rocker).max() < 1e-12


@pytest.mark.parametrize("name", ["output_pin", "coupler_point"])
def test_the_branch_nearest_to_given_places_is_the_one_they_were_taken_from(name):
    six_bar = gk.StephensonSixBar(
        gk.FourBar(100, 30, 90, 70, 40 + 25j, origin=7 - 3j, ground_angle_deg=37), 150, 120, 160j
    )
    rng = np.random.default_rng(3)
    for signs in ({"rocker_pin": a, "output_pin": b} for a in (1, -1) for b in (1, -1)):
        there = gk.move(six_bar, TURN, signs)
        places = {p: there.point(p).position[0] + complex(*rng.uniform(-3, 3, 2)) for p in {name, "output_pin"}}
        near = gk.move(six_bar, TURN, {"rocker_pin": signs["rocker_pin"], **places})
        assert np.array_equal(near.bodies["output"].direction, there.bodies["output"].direction, equal_nan=True)
        alone = gk.move(six_bar, TURN[:1], {"coupler_point": there.point("coupler_point").position[0]})
        assert alone.branches["rocker_pin"] == signs["rocker_pin"]


NEAR = {
    "rocker_pin": gk.FourBar(100, 30, 90, 70, 40 + 25j, origin=7 - 3j, ground_angle_deg=37),
    "slider_pin": gk.SliderCrank(30, 90, 12, origin=7 - 3j, ground_angle_deg=37),
    "tip": gk.Linkage(
        {"ground": {"O": 0, "C": 80}, "crank": {"O": 0, "A": 30}, "block": {"A": 0}, "lever": {"C": 0, "tip": 130}},
        "crank",
        (gk.Slider("slide", "block", "lever", 0, 7j),),
        7 - 3j,
        37.0,
    ),
    "output_pin": gk.WattSixBar(FOUR_BAR, 50 - 30j, 90, 60, 180),
}


@pytest.mark.parametrize("name", NEAR)
@pytest.mark.parametrize("sign", [1, -1])
def test_of_two_branches_the_nearer_one_is_taken_however_little_nearer(name, sign):
    """By places just on this side of the middle between the points of both."""
    joint = {"tip": "slide"}.get(name, name)
    for angle in (0.3, 2.1, 4.4):
        here, there = (gk.move(NEAR[name], [angle], {joint: s}).point(name).position[0] for s in (sign, -sign))
        for aside in (0, 60j):
            place = here + (0.49 + aside) * (there - here)
            assert gk.move(NEAR[name], [angle], {name: place}).branches[joint] == sign


def test_branch_points_choose_the_first_frame_and_start_loops():
    triple_rocker, drive = gk.FourBar(4, 3, 2, 2.5), np.linspace(2.0, -1.0, 20)
    for sign in (1, -1):
        there = gk.move(triple_rocker, drive, sign)
        place = there.point("rocker_pin").position[there.assembled][0]
        assert np.array_equal(
            gk.move(triple_rocker, drive, {"rocker_pin": place}).branches["rocker_pin"], there.branches["rocker_pin"]
        )
    linkage, drive = locked()
    bare = gk.Linkage(linkage.bodies, linkage.driver)
    with pytest.raises(gk.DesignError):
        gk.move(bare, drive)
    reported = gk.move(bare, drive, dict(linkage.estimate))
    assert np.array_equal(reported.point("P").position, gk.move(linkage, drive).point("P").position)


def test_limits_dashes_and_curves_take_the_branch_near_a_place_from_their_start():
    six_bar = gk.StephensonSixBar(gk.FourBar(100, 30, 90, 70, 40 + 25j), 150, 120, 160j)
    signs = {"rocker_pin": -1, "output_pin": -1}
    near = {p: gk.move(six_bar, [0.0], signs).point(p).position[0] for p in signs}
    assert gk.driver_limits(six_bar, near) == gk.driver_limits(six_bar, signs)
    assert np.array_equal(
        gk.linkage.dead_centres(six_bar, "output", near), gk.linkage.dead_centres(six_bar, "output", signs)
    )
    # Hardly nearer to the one branch at the start, and often to the other later.
    pins = [gk.move(six_bar, [0.0], signs | {"output_pin": s}).point("output_pin").position[0] for s in (1, -1)]
    near["output_pin"] = 0.49 * pins[0] + 0.51 * pins[1]
    assert np.array_equal(
        gk.linkage.dead_centres(six_bar, "output", near), gk.linkage.dead_centres(six_bar, "output", signs)
    )
    t = np.array([3.0, 1.0, 2.0])
    curves = [gk.CouplerCurve(six_bar, "output_pin", branch, (0.0, 6.0)).point(t) for branch in (near, signs)]
    assert np.array_equal(*curves)
    drawn = [
        gk.linkage.dashes(six_bar, [10j], np.radians([0, 20, 40, 60]), 0.1, branch, "output")
        for branch in (near, signs)
    ]
    assert all(np.array_equal(a, b) for a, b in zip(drawn[0][0], drawn[1][0], strict=True))


@pytest.mark.parametrize(
    "branch",
    [{"output_pin": 2}, {"output_pin": complex(np.nan, 0)}, {"elsewhere": 1j}, {"coupler_point": 1}, "follow me", True,
     None, {"output_pin": True}, (1, -1)],
)  # fmt: skip
def test_invalid_branch_is_refused(branch):
    with pytest.raises(gk.DesignError) as caught:
        gk.move(gk.StephensonSixBar(FOUR_BAR, 80, 60, 60 + 120j), TURN, branch)
    assert caught.value.field == "branch"


@pytest.mark.parametrize("start", [0, True, None, "follow", {"output_pin": 2}, {"output_pin": complex(np.nan, 0)}])
def test_invalid_start_is_refused(start):
    with pytest.raises(gk.DesignError) as caught:
        gk.Continuation(start)
    assert caught.value.field == "start"


def test_too_many_turns_are_refused_with_a_number_that_works():
    six_bar = gk.StephensonSixBar(FOUR_BAR, 80, 60, 60 + 120j)
    with pytest.raises(gk.DesignError) as caught:
        gk.move(six_bar, [0, 1e9], "follow").assembled
    most = int(caught.value.remedy.split()[-2])
    assert gk.move(six_bar, [0, np.radians(most)], "follow").assembled.all()
    with pytest.raises(gk.DesignError):
        gk.move(six_bar, [0, np.radians(most + 2)], "follow").assembled


def test_too_many_linkages_to_follow_are_refused_with_numbers_that_work(monkeypatch):
    monkeypatch.setattr(branch, "MOST", 2000)

    def closed(count, drive=(0.0, 0.1)):
        bars = gk.FourBar(np.full(count, 100.0), 30, 90, 70, coupler_point=50 + 50j)
        return gk.move(gk.StephensonSixBar(bars, 120, 90, 100 + 100j), drive, "follow").assembled

    def refused(*given):
        with pytest.raises(gk.DesignError) as caught:
            closed(*given)
        return caught.value.field, int(re.search(r"\d+", caught.value.remedy)[0])

    field, most = refused(300)
    assert field == "bodies" and closed(most).all() and 200 < most < 300 and refused(most + 1)[0] == "bodies"
    field, degrees = refused(3, (0.0, 20.0))
    assert field == "drive" and closed(3, (0.0, np.radians(degrees))).all()
    assert refused(3, (0.0, np.radians(degrees + 2)))[0] == "drive"
