"""Linkages that are no chain of dyads: limits, transmission angle and motion by second roads."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.moving import Planner
from geomkin.linkage.solve.loop_equations import LoopEquations
from tests.linkage.examples import ALL, FEW, locked


def posed(linkage, motion, carried=True):
    """The same linkage with its dyads given to iteration, started where a motion stands at first."""
    linkage = linkage.linkage
    pins = {pin: motion.point(pin).position[0] for pin in linkage.pins}
    same = replace(linkage, estimate=pins)
    planner = Planner(same, False)
    planner.drive()
    if carried:
        planner.place_determined()
    planner.place_rest()
    same.plans[False] = tuple(planner.placements)
    # Without the program of the structure, by the placements.
    same.programs[1, (), True] = None, {}
    return same


DYADS = [n for n in FEW if n not in ("loops", "trammel by shuttle", "oldham", "actuator between moving bars")]


@pytest.mark.parametrize("name", DYADS)
def test_dyads_posed_as_loops_move_alike_at_the_same_transmission_angle(name):
    linkage, drive, branch = ALL[name]
    by_dyads = gk.move(linkage, drive, branch, speed=2.0)
    by_loops = gk.move(posed(linkage, by_dyads), drive, speed=2.0)
    assert by_loops.assembled.all()
    for body in by_dyads.bodies:
        one, two = by_dyads.bodies[body].point(3 + 4j), by_loops.bodies[body].point(3 + 4j)
        assert two.position == pytest.approx(one.position, abs=1e-11)
        assert two.velocity == pytest.approx(one.velocity, abs=1e-10)
        assert two.acceleration == pytest.approx(one.acceleration, rel=1e-10, abs=1e-9)
    assert by_loops.transmission_angle == pytest.approx(by_dyads.transmission_angle, abs=1e-13)
    assert by_loops.error_amplification == pytest.approx(by_dyads.error_amplification, rel=1e-12)


def by_output(seed):
    """A six-bar driven by its last link, and as driven by its crank: a function from crank angle to pose."""
    rng = np.random.default_rng(seed)
    sizes = 100.0, *(rng.uniform(*ends) for ends in ((20, 32), (80, 95), (68, 80)))
    pen, pivot = complex(rng.uniform(20, 60), rng.uniform(10, 50)), complex(rng.uniform(30, 90), rng.uniform(100, 140))
    bodies = {
        "ground": {"O": 0, "C": sizes[0], "E": pivot},
        "crank": {"O": 0, "A": sizes[1]},
        "coupler": {"A": 0, "B": sizes[2], "P": pen},
        "rocker": {"C": 0, "B": sizes[3]},
        "rod": {"P": 0, "D": 140},
        "out": {"E": 0, "D": 120},
    }
    by_crank = gk.Linkage(bodies, "crank")

    def started(crank):
        motion = gk.move(by_crank, [crank])
        pins = {pin: motion.point(pin).position[0] for pin in "ABPD"}
        return gk.Linkage(bodies, "out", estimate=pins), float(np.angle(motion.bodies["out"].direction[0]))

    return by_crank, started


def extreme(by_crank, low, high):
    """The output's farthest angle for cranks between, by search in thirds: it is known to the square of the crank's."""
    for _ in range(5):
        cranks = np.linspace(low, high, 2001)
        out = np.unwrap(np.angle(gk.move(by_crank, cranks).bodies["out"].direction))
        sign = 1 if out[1000] > out[0] else -1
        best = int(np.argmax(sign * out))
        low, high = cranks[max(best - 1, 0)], cranks[min(best + 1, 2000)]
    return np.exp(1j * out[best])


@pytest.mark.parametrize("seed", range(2))
def test_limits_are_exact_whatever_the_start_and_the_span(seed):
    """The crank turns fully, so the output swings between two limits, which the crank's dyads know in closed form."""
    by_crank, started = by_output(seed)
    turn = np.linspace(0, 2 * np.pi, 4001)
    out = np.unwrap(np.angle(gk.move(by_crank, turn).bodies["out"].direction))
    rising = np.diff(out) > 0
    # A stretch of rising output between two limits, and starts inside it.
    begin = int(np.flatnonzero(~rising[:-1] & rising[1:])[0]) + 1
    length = int(np.argmin(np.roll(rising, -begin)))
    step = turn[1]
    limit = extreme(by_crank, turn[begin] + (length - 3) * step, turn[begin] + (length + 3) * step)
    for share in (0.2, 0.9):
        linkage, start = started(turn[begin] + share * length * step)
        for width in (2.0, 5.0):
            ((low, high),) = gk.driver_limits(linkage, span=(start, start + width))
            assert low == start
            assert np.exp(1j * high) == pytest.approx(limit, abs=2e-14)


def test_frames_do_not_depend_on_their_order():
    linkage, drive = locked()
    row = np.linspace(drive[0], drive[0] + 0.5, 50)
    whole = gk.move(linkage, row).point("D").position
    mixed = np.array([0, 49, 3, 30, 30, 1])
    assert gk.move(linkage, row[mixed]).point("D").position == pytest.approx(whole[mixed], abs=1e-12)


def triad(seed, size=1.0):
    """Three bars on one plate, driven by a crank: no dyad in it. The drive's start, and data for a second solver."""
    rng = np.random.default_rng(seed)
    bases = np.array([rng.uniform(15, 40), 100, 50 + 90j])
    corners = np.array([0, rng.uniform(30, 70), complex(rng.uniform(10, 50), rng.uniform(20, 60))])
    place, angle, start = complex(rng.uniform(0, 60), rng.uniform(10, 60)), rng.uniform(0, 6), rng.uniform(0, 6)
    pins = place + corners * np.exp(1j * angle)
    bars = np.abs(pins - bases * np.exp(1j * np.array([start, 0, 0])))
    bodies = {
        "ground": {"O": 0, "C": bases[1] * size, "E": bases[2] * size},
        "crank": {"O": 0, "A": bases[0] * size},
        "plate": dict(zip("BDF", corners * size)),
        "one": {"A": 0, "B": bars[0] * size},
        "two": {"C": 0, "D": bars[1] * size},
        "three": {"E": 0, "F": bars[2] * size},
    }
    linkage = gk.Linkage(bodies, "crank", estimate=dict(zip("BDF", pins * size)))
    return linkage, start, (bases, corners, bars, [place.real / 100, place.imag / 100, angle, start])


def walked(bases, corners, bars, pose):
    """The crank's limit by a walk along the curve of plate poses: distances between pins only, three unknowns."""

    def equations(y):
        turned, driven = np.exp(1j * y[2]) * corners, bases * np.exp(1j * y[3] * np.array([1, 0, 0]))
        apart = 100 * complex(y[0], y[1]) + turned - driven
        slopes = [100, 100j, 1j * turned, -1j * driven * np.array([1, 0, 0])]
        return (np.abs(apart) ** 2 - bars**2) / 1e4, np.array([2 * np.real(np.conj(apart) * s) for s in slopes]).T / 1e4

    def beside(guess, way):
        y = guess
        for _ in range(8):
            value, slopes = equations(y)
            y = y - np.linalg.solve(np.vstack([slopes, way]), np.append(value, way @ (y - guess)))
        ahead = np.linalg.svd(equations(y)[1])[2][-1]
        return y, ahead * np.sign(ahead @ way)

    y = np.array(pose)
    way = np.linalg.svd(equations(y)[1])[2][-1]
    way = way * np.sign(way[3])
    while y[3] < pose[3] + 2 * np.pi:
        ahead, turned = beside(y + 0.02 * way, way)
        if turned[3] <= 0:
            low, high = 0.0, 0.02
            for _ in range(45):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if beside(y + middle * way, way)[1][3] > 0 else (low, middle)
            return beside(y + low * way, way)[0][3]
        y, way = ahead, turned
    return pose[3] + 2 * np.pi


@pytest.mark.parametrize(("seed", "size"), [(1, 1e-7), (2, 1.0), (4, 1e7)])
def test_limits_of_a_triad_agree_with_a_walk_along_its_curve(seed, size):
    linkage, start, data = triad(seed, size)
    ((low, high),) = gk.driver_limits(linkage, span=(start, start + 2 * np.pi))
    assert low == start and high == pytest.approx(walked(*data), abs=1e-13)
    motion = gk.move(linkage, np.linspace(start, high, 50))
    assert motion.assembled.all() and motion.residual.max() < 1e-13 * 200 * size


def test_transmission_angle_agrees_with_a_change_of_length():
    """A bar longer by e pushes its pin e / sin of the angle between the bar and the normal of the pin's way."""
    linkage, start, _ = triad(3)
    motion = gk.move(linkage, [start])
    least = []
    for bar, inner in (("one", "B"), ("two", "D"), ("three", "F")):
        e, ends = 1e-4, []
        for longer in (-e, e):
            bodies = dict(linkage.bodies)
            bodies[bar] = {pin: z * (1 + longer / abs(z) if pin == inner else 1) for pin, z in bodies[bar].items()}
            ends.append(gk.move(gk.Linkage(bodies, "crank", estimate=linkage.estimate), [start]).point(inner).position)
        least.append(np.arcsin(2 * e / np.abs(ends[1] - ends[0])[0]))
    assert motion.transmission_angle[0] == pytest.approx(min(least), abs=1e-6)


def test_error_amplification_grows_and_transmission_angle_vanishes_near_a_lock():
    for linkage, start in (triad(3)[:2], (locked()[0], locked()[1][0])):
        ((_, limit),) = gk.driver_limits(linkage, span=(start, start + 6))
        motion = gk.move(linkage, [start, *(limit - np.array([1e-4, 1e-6, 1e-8, 0]))])
        # The lock's own square root: a hundred times nearer, ten times more sensitive.
        assert motion.error_amplification[2:4] / motion.error_amplification[1:3] == pytest.approx([10, 10], rel=0.05)
        assert motion.transmission_angle[0] > 0.1 and motion.transmission_angle[4] < 1e-6


def test_lone_driver_has_no_transmission_angle():
    lone = gk.Linkage({"ground": {"O": 0}, "crank": {"O": 0, "pen": 30}}, "crank")
    motion = gk.move(lone, [0.0, 1.0])
    assert motion.assembled.all() and np.isnan(motion.transmission_angle).all()
    assert np.isnan(motion.error_amplification).all()


def test_a_parallelogram_stays_one_through_its_change_points():
    drive = np.linspace(0.4, 0.4 + 4 * np.pi, 200)
    first = gk.move(gk.FourBar(3, 2, 3, 2), drive[:1])
    motion = gk.move(posed(gk.FourBar(3, 2, 3, 2), first), drive)
    assert motion.assembled.all()
    assert motion.rocker.direction == pytest.approx(motion.crank.direction, abs=1e-9)
    nearly = gk.FourBar(3, 2, 3, 2 + 1e-7)
    by_dyads, by_loops = gk.move(nearly, drive), gk.move(posed(nearly, gk.move(nearly, drive[:1])), drive)
    assert np.array_equal(by_loops.assembled, by_dyads.assembled)
    assert by_loops.rocker.direction == pytest.approx(by_dyads.rocker.direction, abs=1e-8, nan_ok=True)


def test_loops_end_where_a_dyad_before_them_does():
    """A four-bar whose crank stops, with three bars on a plate hung on its rocker."""
    driven = gk.FourBar(100, 75, 50, 62.5).linkage
    bodies = {name: dict(points) for name, points in driven.bodies.items()}
    bodies["ground"] |= {"E": 60 - 200j, "G": 220 - 150j}
    rest = {"plate": {"P": 0, "Q": 60, "R": 30 + 40j}}
    pins = {"P": 90 - 90j, "Q": 150 - 90j, "R": 120 - 50j}
    start = 1.2
    motion = gk.move(driven, [start])
    hung = motion.point("rocker_pin").position[0]
    rest |= {"one": {"rocker_pin": 0, "R": abs(pins["R"] - hung)}}
    rest |= {"two": {"E": 0, "P": abs(pins["P"] - bodies["ground"]["E"])}}
    rest |= {"three": {"G": 0, "Q": abs(pins["Q"] - bodies["ground"]["G"])}}
    linkage = gk.Linkage(bodies | rest, "crank", estimate=pins)
    ((_, limit),) = gk.driver_limits(driven, span=(start, 3))
    assert gk.driver_limits(linkage, span=(start, 3)) == ((start, pytest.approx(limit, abs=1e-13)),)


def test_many_linkages_at_once_are_refused_where_iteration_is_needed():
    linkage, start, _ = triad(4)
    bodies = dict(linkage.bodies) | {"crank": {"O": 0, "A": np.array([30.0, 31.0])}}
    with pytest.raises(gk.DesignError) as caught:
        gk.move(gk.Linkage(bodies, "crank", estimate=linkage.estimate), [start])
    assert caught.value.field == "bodies"


def test_no_frames_are_no_fault():
    assert gk.move(locked()[0], []).assembled.shape == (0,)


@pytest.mark.parametrize("at", [2.0])
def test_the_transmission_angle_does_not_depend_on_the_order_of_bodies(at):
    """At pins of three bodies each of them is the one that leaves the others: here the leg drives, no dyad is left."""
    linkage, _, branch = ALL["walking leg"]
    there, names = gk.move(linkage, [at], branch), list(linkage.bodies)[1:]
    pins = {pin: there.point(pin).position[0] for pin in linkage.pins}
    found = []
    for shift in range(len(names)):
        order = ["ground", *names[shift:], *names[:shift]]
        turned = gk.Linkage({name: linkage.bodies[name] for name in order}, "leg", estimate=pins)
        found += gk.move(turned, np.angle(there.leg.direction)).transmission_angle.tolist()
    assert found == pytest.approx(len(names) * found[:1], abs=1e-12)


def test_transmission_angle_of_locked_and_unknown_poses():
    """A parallelogram in line, one pose of it unknown, and standing square."""
    bodies = {"ground": {"O": 0, "C": 100}, "crank": {"O": 0, "A": 30}, "coupler": {"A": 0, "B": 100}}
    linkage = gk.Linkage({**bodies, "rocker": {"C": 0, "B": 30}}, "crank")
    placed = frozenset({"ground", "crank"})
    equations = LoopEquations(linkage, ("coupler", "rocker"), placed, placed)
    origins = np.array([[0, 0, 30, 100], [0, 0, 30, 100], [0, 0, 30j, 100], [0, 0, 30, 100]], dtype=complex)
    turns = np.array([[1, 1, 1, 1], [1, 1, np.nan, 1], [1, 1j, 1, 1j], [1, 1, 1, 1]], dtype=complex)
    assert equations.transmission_angle((origins, turns)) == pytest.approx([0, np.nan, np.pi / 2, 0], nan_ok=True)


def test_an_estimate_within_a_fifth_of_the_size_leads_to_one_pose_whatever_its_last_bits():
    """A six-bar by its last link, its pins estimated wrong by some 20 mm: it closes, and 1e-12 mm decide nothing."""
    bodies = {
        "ground": {"O": 0, "C": 100, "E": 100 + 100j},
        "crank": {"O": 0, "A": 30},
        "coupler": {"A": 0, "B": 90, "P": 50 + 50j},
        "rocker": {"C": 0, "B": 70},
        "rod": {"P": 0, "F": 120},
        "out": {"E": 0, "F": 90},
    }
    by_crank = gk.move(gk.Linkage(bodies, "crank"), [0.8])
    angle = np.angle(by_crank.bodies["out"].direction)
    rng = np.random.default_rng(5)
    for _ in range(25):
        reported = {pin: complex(by_crank.point(pin).position[0]) + 20 * complex(*rng.normal(size=2)) for pin in "ABP"}
        one, two = (
            gk.move(gk.Linkage(bodies, "out", estimate={pin: z + more for pin, z in reported.items()}), angle)
            for more in (0, 1e-12)
        )
        assert one.assembled.all() and two.assembled.all()
        assert one.point("A").position == pytest.approx(two.point("A").position, abs=1e-6)


def test_loops_behind_a_cylinder_stand_as_behind_the_link_that_it_turns():
    """The drive is known and stands in no equation of theirs."""
    plain, turns = locked()
    bodies = {name: dict(points) for name, points in plain.bodies.items()}
    bodies["ground"]["G"], bodies["out"]["K"] = 150 + 60j, 30 + 0j
    bodies |= {"cylinder": {"G": 0j}, "piston": {"K": 0j}}
    lifted = gk.Linkage(bodies, "lift", (gk.Slider("lift", "piston", "cylinder"),), estimate=plain.estimate)
    stroke = np.abs(60 + 120j + 30 * np.exp(1j * turns) - (150 + 60j))
    for sign in (1, -1):
        motion = gk.move(lifted, stroke, sign)
        if abs(motion.bodies["out"].direction[0] - np.exp(1j * turns[0])) < 1e-9:
            break
    wanted = gk.move(plain, turns)
    assert wanted.assembled.all() and motion.assembled.all()
    for name in ("crank", "coupler", "rod"):
        assert np.abs(motion.bodies[name].direction - wanted.bodies[name].direction).max() < 1e-11
