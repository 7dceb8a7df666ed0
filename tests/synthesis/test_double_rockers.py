"""Double rockers from two starts and two swings: every verdict and the best against simulation."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import double_rocker


def simulated(linkage, wish, frames=1801):
    """Whether it starts where it is to, on which branch, and whether it swings there by itself; with its least angle.

    Both branches are moved, and the one that starts at the rocker's place is followed frame by frame.
    """
    start, swing, out, turn = np.radians(wish)
    drive = np.linspace(start, start + swing, frames)
    for branch in (1, -1):
        motion = gk.move(linkage, drive, branch)
        if motion.assembled[0] and abs(motion.rocker.direction[0] - np.exp(1j * out)) < 1e-7:
            angle = np.unwrap(np.angle(motion.rocker.direction))
            sound = motion.assembled.all() and abs(angle[-1] - angle[0] - turn) < 1e-6
            back = sound and np.ptp(angle) > abs(turn) + 1e-6
            return branch, sound, back, np.degrees(motion.transmission_angle.min())
    raise AssertionError("it does not stand at the first place")


def kind_of_defect(linkage, wish, branch):
    """By the circuits of the package, which are of another's rule, and by the poses put together by hand."""
    start, swing, out, turn = np.radians(wish)
    drive = np.array([start, start + swing])
    other = {}
    for sign in (1, -1):
        motion = gk.move(linkage, drive, sign)
        if motion.assembled[1] and abs(motion.rocker.direction[1] - np.exp(1j * (out + turn))) < 1e-6:
            other[sign] = gk.linkage.circuits(linkage, motion)[1]
    first = gk.linkage.circuits(linkage, gk.move(linkage, drive, branch))[0]
    if first not in other.values():
        return "circuit"
    return "branch" if branch not in other else "order"


def random_wishes(count, seed):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield tuple(rng.uniform(-1, 1, 4) * (180, 200, 180, 200))


def judge(wish, seen):
    try:
        found = double_rocker(*wish)
    except gk.DesignError as error:
        assert error.field in ("rocker_start_deg", "largest_ratio")
        seen.add(error.field)
        return
    branch, sound, back, least = simulated(found.linkage, wish)
    assert (found.branch, not found.defects) == (branch, sound)
    if sound:
        assert found.transmission_angle_deg == pytest.approx(least, abs=0.5)
        assert found.transmission_angle_deg <= least + 1e-9
        assert found.rocker_swing_deg == pytest.approx(wish[3], abs=1e-6)
        assert (found.overshoot_deg > np.degrees(1e-6)) == back
        seen.add("back" if back else "sound")
    else:
        assert found.defects == (kind_of_defect(found.linkage, wish, branch),)
        seen.add(found.defects[0])
    # One with a defect is taken only where the family has none without.
    many, angles = found.family.linkage, found.family.transmission_angle_deg
    sizes = np.array([many.ground, many.crank, many.coupler, many.rocker])
    like = sizes.max(axis=0) < 100 * sizes.min(axis=0)
    assert np.isnan(angles[like]).all() or not found.defects


@pytest.mark.campaign
def test_every_verdict_agrees_with_simulation():
    seen = set()
    for wish in random_wishes(30, 1):
        judge(wish, seen)
    assert seen >= {"sound", "back", "circuit", "branch", "order", "rocker_start_deg"}


@pytest.mark.campaign
def test_whole_angles_at_which_much_vanishes_are_judged_too():
    """Links in line, parallel, mirrored: where rounding could decide, the drive is none, and that is said."""
    rng, count = np.random.default_rng(8), 0
    starts = np.arange(-360, 361, 15)
    for _ in range(200):
        wish = tuple(float(rng.choice(starts if k % 2 == 0 else starts[1:-1][starts[1:-1] != 0])) for k in range(4))
        try:
            found = double_rocker(*wish)
        except gk.DesignError as error:
            assert error.field in ("rocker_start_deg", "largest_ratio") and "inf" not in str(error)
            continue
        try:
            _, sound, _, least = simulated(found.linkage, wish)
        except AssertionError:
            # All in line at the first place, which by its last digits is just out of reach.
            sound, least = False, 0.0
        assert sound == (not found.defects) or (found.defects and least < 1e-3)
        count += 1
    assert count > 60


@pytest.mark.campaign
def test_every_verdict_of_thousands_agrees_with_simulation():
    seen = set()
    for wish in random_wishes(1200, 2):
        judge(wish, seen)


@pytest.mark.parametrize(
    "wish",
    [
        (130, -60, 100, -75),
        pytest.param((60, 60, 60, 60), marks=pytest.mark.campaign),
        (10, 140, 120, 35),
    ],
)
@pytest.mark.parametrize("ratio", [10.0])
def test_the_best_is_the_best_of_all_cranks_and_rockers(wish, ratio):
    """Brute force: the coupler must be as long in both places; for each crank the rocker is solved for, and moved."""
    try:
        best = double_rocker(*wish, largest_ratio=ratio)
    except gk.DesignError as error:
        assert error.field == "largest_ratio"
        return
    start, swing, out, turn = np.radians(wish)
    pins, arms = np.exp(1j * np.array([start, start + swing])), np.exp(1j * np.array([out, out + turn]))
    cranks = np.geomspace(1 / 12, 12, 4001)
    # |1 + c e4 - a e2|2 alike in both places, linear in c.
    part = [2 * (arm.real - cranks * (arm * np.conj(pin)).real) for pin, arm in zip(pins, arms)]
    rest = [-2 * cranks * pin.real for pin in pins]
    with np.errstate(divide="ignore", invalid="ignore"):
        rockers = (rest[1] - rest[0]) / (part[0] - part[1])
    if wish == (60, 60, 60, 60):
        rockers = cranks
        couplers = np.ones_like(cranks)
    couplers = np.abs(1 + rockers * arms[0] - cranks * pins[0])
    sizes = np.array([np.ones_like(cranks), cranks, couplers, rockers])
    with np.errstate(divide="ignore", invalid="ignore"):
        sizes = sizes[:, (rockers > 0) & (sizes.max(axis=0) / sizes.min(axis=0) <= ratio)]
    top = 0.0
    drive = np.linspace(start, start + swing, 241)
    for branch in (1, -1):
        motion = gk.move(gk.FourBar(*sizes), drive, branch)
        angle = np.unwrap(np.angle(np.where(motion.assembled, motion.rocker.direction, 1)), axis=0)
        fits = motion.assembled.all(axis=0) & (abs(angle[-1] - angle[0] - turn) < 1e-6)
        fits &= (abs(motion.rocker.direction[0] - arms[0]) < 1e-6) & (np.ptp(angle, axis=0) < abs(turn) + 1e-6)
        top = max(top, np.degrees(np.where(fits, motion.transmission_angle.min(axis=0), 0)).max(initial=0))
    if top == 0:
        assert best.defects or best.overshoot_deg > 0
    else:
        assert not best.defects and top - 0.05 < best.transmission_angle_deg < top + 0.4


def test_a_known_linkage_is_found_again_from_its_own_swings():
    rng = np.random.default_rng(6)
    count = 0
    for _ in range(80):
        crank, coupler, rocker = rng.uniform(0.4, 1.6, 3)
        start, swing = rng.uniform(-150, 150), rng.uniform(-100, 100)
        if max(1, crank, coupler, rocker) >= 0.5 * (1 + crank + coupler + rocker) or abs(swing) < 5:
            continue
        known = gk.FourBar(1, crank, coupler, rocker)
        motion = gk.move(known, np.radians(np.linspace(start, start + swing, 181)), -1)
        if not motion.assembled.all() or motion.transmission_angle.min() < 0.02:
            continue
        out = np.degrees(np.unwrap(np.angle(motion.rocker.direction)))
        if abs(out[-1] - out[0]) < 2:
            continue
        for given in ({"crank": crank}, {"rocker": rocker}):
            again = double_rocker(start, swing, out[0], out[-1] - out[0], **given)
            assert list(again.lengths.values()) == pytest.approx([1, crank, coupler, rocker], rel=1e-7)
            assert again.defects == () and again.branch == -1
        count += 1
    assert count > 15


@pytest.mark.parametrize("ground", [1e-6])
def test_the_ground_sets_the_size(ground):
    found, unit = double_rocker(60, 60, 80, 40, ground), double_rocker(60, 60, 80, 40)
    assert list(found.lengths.values()) == pytest.approx([ground * size for size in unit.lengths.values()], rel=1e-9)
    assert found.transmission_angle_deg == pytest.approx(unit.transmission_angle_deg, abs=1e-9)


def test_like_swings_from_like_starts_are_a_parallelogram():
    found = double_rocker(60, 60, 60, 60, 80, crank=50)
    assert list(found.lengths.values()) == pytest.approx([80, 50, 80, 50]) and found.defects == ()


@pytest.mark.parametrize(
    ("wish", "given", "field"),
    [
        ((60, 0, 80, 40), {}, "crank_swing_deg"),
        ((60, 60, 80, 0.05), {}, "rocker_swing_deg"),
        ((60, 360, 80, 40), {}, "crank_swing_deg"),
        ((-30, 60, -20, 40), {}, "rocker_start_deg"),
        ((120, -60, 40, 70), {}, "rocker_start_deg"),
        ((60, 60, 80, 40), {"crank": 1.0, "rocker": 1.0}, "rocker"),
        ((60, 60, 80, 40), {"free_angle_deg": 90}, "free_angle_deg"),
        ((60, 60, 80, 40), {"largest_ratio": 1.01}, "largest_ratio"),
        ((60, 60, 80, 40), {"rocker": 30}, "rocker"),
        ((60, 60, 80, 40), {"ground": 0}, "ground"),
    ],
)
def test_invalid_requests_are_refused(wish, given, field):
    with pytest.raises(gk.DesignError) as caught:
        double_rocker(*wish, **given)
    assert caught.value.field == field and caught.value.remedy


def test_the_numbers_that_refusals_name_work():
    with pytest.raises(gk.DesignError):
        double_rocker(30, 100, 120, -60, 100, crank=200)
    assert double_rocker(30, 100, 120, -60, 100, crank=292.381).linkage.crank == 292.381
    assert double_rocker(60, 60, 80, 40, rocker=16.5817).linkage.rocker == 16.5817
    assert double_rocker(120, -60, 56, 70).ratio <= 100
    with pytest.raises(gk.DesignError) as caught:
        double_rocker(60, 60, 80, 40, largest_ratio=1.01)
    least = float(caught.value.remedy.rsplit(" ", 1)[1])
    assert double_rocker(60, 60, 80, 40, largest_ratio=least).ratio <= least * (1 + 1e-9)
    with pytest.raises(gk.DesignError):
        double_rocker(60, 60, 80, 40, largest_ratio=least / 1.004)


@pytest.mark.parametrize(("wish", "name"), [((-30, 60, 100, -40), "crank"), ((100, 40, -30, 60), "rocker")])
def test_a_length_that_is_the_same_in_all_is_reported(wish, name):
    """Where a link's two places mirror each other in the ground line, the other one alone is free."""
    with pytest.raises(gk.DesignError) as caught:
        double_rocker(*wish, 100, **{name: 1234.5})
    reported = float(caught.value.remedy.split()[5])
    for free in (10, 40, 80):
        assert getattr(double_rocker(*wish, 100, free_angle_deg=free).linkage, name) == pytest.approx(
            reported, rel=1e-6
        )
    other = {"crank": "rocker", "rocker": "crank"}[name]
    assert getattr(double_rocker(*wish, 100, **{other: 1234.5}).linkage, name) == pytest.approx(reported, rel=1e-6)


@pytest.mark.parametrize("wish", [(-120, 60, -40, -70), (-90, 180, 330, -250)])
def test_the_start_that_a_refusal_names_is_the_nearest_that_works(wish):
    with pytest.raises(gk.DesignError) as caught:
        double_rocker(*wish)
    crank, swing, start, out = wish

    def works(at):
        try:
            double_rocker(crank, swing, at, out)
        except gk.DesignError as error:
            return error.field != "rocker_start_deg"
        return True

    if "nearest" in caught.value.remedy:
        reported = int(caught.value.remedy.split()[1])
        assert works(reported) and not any(
            works(start + k) for k in range(-abs(reported - start) + 1, abs(reported - start))
        )
    else:
        assert not any(works(at) for at in range(-359, 360, 17))


@pytest.mark.parametrize(
    ("wish", "ratio"),
    [((10, 140, 120, 35), 3.0)],
)
def test_reported_input_range_is_exact_to_rounding(wish, ratio):
    """Where crank and ground, and crank and coupler, are in line is met, and not only nearly: beside very fine steps."""
    found = double_rocker(*wish, largest_ratio=ratio)
    drive = np.radians(np.linspace(wish[0], wish[0] + wish[1], 200_001))
    motion = gk.move(found.linkage, drive, found.branch)
    angle = np.degrees(np.unwrap(np.angle(motion.rocker.direction)))
    assert found.overshoot_deg == pytest.approx(np.ptp(angle) - abs(angle[-1] - angle[0]), abs=1e-8)
    assert found.transmission_angle_deg == pytest.approx(np.degrees(motion.transmission_angle.min()), abs=1e-6)
