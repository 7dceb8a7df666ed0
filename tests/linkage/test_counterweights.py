"""Counterweights: published balances, rules of thumb, and the least value of a search over masses, radii and angles."""

import numpy as np
import pytest

import geomkin as gk
from tests.campaign import by_default

TURN = np.linspace(0, 2 * np.pi, 72, endpoint=False)
FOUR_BAR = gk.FourBar(100, 50, 151, 111)
BARS = {
    "crank": gk.Mass(0.2, centre=20, inertia=100),
    "coupler": gk.Mass(0.5, centre=75.5, inertia=1210),
    "rocker": gk.Mass(0.4, centre=55.5, inertia=910),
}


def rms(result, objective):
    """Root mean square over the frames; of the driver's deviation from its mean."""
    values = getattr(result, objective)
    return np.sqrt(np.mean(np.abs(values - (values.mean() if objective == "driver" else 0)) ** 2))


def with_weights(motion, loads, weights):
    """Forces with point masses (body, mass, place) added, computed from the equations of motion anew."""
    masses = dict(loads.masses)
    for body, mass, place in weights:
        masses[body] = masses.get(body, gk.Mass(0.0)) + gk.Mass(mass, place)
    return gk.forces(motion, gk.Loads(loads.gravity, masses, loads.forces))


@pytest.mark.parametrize("centre", [75.5, 60 + 25j])
def test_a_four_bar_is_force_balanced_by_the_conditions_of_berkof_and_lowen(centre):
    """m r of crank and rocker: -m a (1 - z / b) and -m (c / b) z, less their own; z = centre of the coupler."""
    motion = gk.move(FOUR_BAR, TURN, speed=95.0, acceleration=40.0)
    loads = gk.Loads(-9810j, BARS | {"coupler": gk.Mass(0.5, centre, 1210)})
    best = gk.balance(motion, loads, ["crank", "rocker"], max_mass=5.0, max_radius=40.0)
    for body, moment in {
        "crank": -0.5 * 50 * (1 - centre / 151) - 0.2 * 20,
        "rocker": -0.5 * 111 / 151 * centre - 0.4 * 55.5,
    }.items():
        weight = best.counterweights[body]
        assert weight.mass * weight.centre == pytest.approx(moment, rel=1e-9)
        assert abs(weight.centre) == pytest.approx(40)
    assert np.abs(best.after.shaking_force).max() < 1e-9 * np.abs(best.before.shaking_force).max()
    # A pure couple is left, the same about every point.
    elsewhere = gk.forces(motion, best.after.loads, about=300 - 70j)
    assert elsewhere.shaking_moment == pytest.approx(best.after.shaking_moment, rel=1e-8)


def test_the_price_of_full_force_balance_is_that_of_an_independent_calculation():
    """Peaks over 360 frames: the moment hardly falls, torque and pin force rise; weights at 40 and 60 mm."""
    motion = gk.move(FOUR_BAR, np.radians(np.arange(360)), speed=95.0)
    loads = gk.Loads(masses=BARS)
    best = gk.balance(motion, loads, ["crank", "rocker"], max_mass=5.0, max_radius=60.0)
    assert best.counterweights["rocker"].mass == pytest.approx(0.8325, rel=1e-9)
    assert best.counterweights["crank"].mass * 60 == pytest.approx(0.4125 * 40, rel=1e-9)
    closer = with_weights(motion, loads, [("crank", 0.4125, -40), ("rocker", 0.8325, -60)])
    for result, peaks in (best.before, (1744.72, 241851, 133990, 5674)), (closer, (0, 229812, 227320, 9404)):
        pin = result.pin("crank_pin", on="coupler")
        for values, peak in zip((result.shaking_force, result.shaking_moment, result.driver, pin), peaks, strict=True):
            assert np.abs(values).max() == pytest.approx(peak, rel=1e-4, abs=1e-8)


def test_half_of_the_reciprocating_mass_balances_a_slider_crank_with_a_long_rod():
    motion = gk.move(gk.SliderCrank(30, 3e6), TURN, speed=20.0)
    best = gk.balance(motion, gk.Loads(masses={"slider": gk.Mass(2.0)}), ["crank"], max_mass=9.0, max_radius=15.0)
    weight = best.counterweights["crank"]
    assert weight.mass * weight.centre == pytest.approx(-1.0 * 30, rel=1e-5)
    # What is left has the same size all round: half of the force.
    assert np.abs(best.after.shaking_force) == pytest.approx(1e-3 * 30 * 20**2, rel=1e-4)


CASES = {
    "light crank weight": (["crank"], "shaking_force", 0.2, 30.0),
    "two light weights": (["crank", "rocker"], "shaking_force", 0.3, 40.0),
    "one of two at its bound": (["crank", "rocker"], "shaking_force", 0.6, 40.0),
    "moment by the rocker": (["rocker"], "shaking_moment", 0.3, 60.0),
    "moment by both": (["crank", "rocker"], "shaking_moment", 0.3, 60.0),
    "torque by the crank": (["crank"], "driver", 0.5, 60.0),
    "torque by the rocker": (["rocker"], "driver", 0.3, 60.0),
    "torque by both": (["crank", "rocker"], "driver", 0.4, 50.0),
}


@pytest.mark.parametrize("case", by_default(list(CASES)[::2], slice(0, None, 2)))
def test_no_other_counterweights_of_a_search_are_better(case):
    """A grid over mass, radius and angle of each weight, refined about its best point again and again."""
    bodies, objective, max_mass, max_radius = CASES[case]
    motion = gk.move(FOUR_BAR, TURN, speed=12.0, acceleration=15.0)
    loads = gk.Loads(-9810j, BARS, [gk.Force("rocker", 111, -3j)])
    best = gk.balance(motion, loads, bodies, objective, max_mass=max_mass, max_radius=max_radius)
    pivots = {"crank": 0, "rocker": 0}
    for body, weight in best.counterweights.items():
        assert 0 <= weight.mass <= max_mass and abs(weight.centre - pivots[body]) <= max_radius * (1 + 1e-12)
    placed = [(body, weight.mass, weight.centre) for body, weight in best.counterweights.items()]
    value = rms(with_weights(motion, loads, placed), objective)
    assert value == pytest.approx(rms(best.after, objective), rel=1e-12)
    assert (best.rms_before, best.rms_after) == pytest.approx((rms(best.before, objective), value), rel=1e-12)
    searched = least_by_search(motion, loads, bodies, objective, max_mass, max_radius)
    assert value <= searched * (1 + 1e-9)
    # The search comes close, so that the comparison means something.
    assert value == pytest.approx(searched, rel=2e-3)
    assert value < 0.999 * best.rms_before


@pytest.mark.parametrize("objective", ["shaking_force", "shaking_moment", "driver"])
def test_no_counterweight_of_a_search_has_a_smaller_maximum(objective):
    """Points on finer and finer grids of the weight of the crank, in mass, radius and angle."""
    motion = gk.move(FOUR_BAR, TURN, speed=12.0, acceleration=15.0)
    loads = gk.Loads(-9810j, BARS, [gk.Force("rocker", 111, -3j)])
    bounds = {"max_mass": 0.4, "max_radius": 50.0}
    plain = gk.balance(motion, loads, ["rocker"], objective, **bounds)
    best = gk.balance(motion, loads, ["rocker"], objective, measure="maximum", **bounds)
    weight = best.counterweights["rocker"]
    assert 0 <= weight.mass <= 0.4 and abs(weight.centre) <= 50 * (1 + 1e-12)

    def largest(mass, radius, angle):
        values = getattr(with_weights(motion, loads, [("rocker", mass, radius * np.exp(1j * angle))]), objective)
        return np.abs(values - (values.mean() if objective == "driver" else 0)).max()

    random, middle, width = np.random.default_rng(3), np.array([0.5, 0.5, 0.5]), 1.0
    least = np.inf
    for _ in range(10):
        shares = np.clip(middle + width * random.uniform(-0.5, 0.5, (12, 3)), 0, 1)
        values = [largest(0.4 * a, 50 * b, 2 * np.pi * c) for a, b, c in shares]
        if min(values) < least:
            least, middle = min(values), shares[int(np.argmin(values))]
        width *= 0.75
    assert best.largest_after <= least * (1 + 1e-9)
    assert best.largest_after == pytest.approx(largest(weight.mass, abs(weight.centre), np.angle(weight.centre)))
    assert best.largest_after <= plain.largest_after * (1 + 1e-12)
    assert best.rms_after >= plain.rms_after * (1 - 1e-12)


@pytest.mark.campaign
def test_no_other_counterweights_of_a_search_are_better_for_random_four_bars():
    random, tried = np.random.default_rng(7), 0
    while tried < 60:
        linkage = gk.FourBar(*random.uniform(40, 120, 4))
        motion = gk.move(linkage, TURN, speed=random.uniform(2, 30), acceleration=random.uniform(-90, 90))
        if not motion.assembled.all() or motion.error_amplification.max() > 30:
            continue
        names = ["crank", "coupler", "rocker"]
        masses = {
            name: gk.Mass(random.uniform(0.1, 1), complex(*random.uniform(-40, 40, 2)), random.uniform(0, 900))
            for name in names
        }
        loads = gk.Loads(-9810j, masses)
        bodies = [["crank"], ["rocker"], ["crank", "rocker"]][tried % 3]
        objective = ["shaking_force", "shaking_moment", "driver"][tried // 3 % 3]
        max_mass, max_radius = random.uniform(0.1, 2), random.uniform(10, 80)
        best = gk.balance(motion, loads, bodies, objective, max_mass=max_mass, max_radius=max_radius)
        searched = least_by_search(motion, loads, bodies, objective, max_mass, max_radius)
        assert best.rms_after <= searched * (1 + 1e-9), (tried, bodies, objective)
        assert best.rms_after == pytest.approx(searched, rel=0.05, abs=1e-3 * best.rms_before), (tried, objective)
        tried += 1


def least_by_search(motion, loads, bodies, objective, max_mass, max_radius):
    """Least rms of random weights, from many to ever closer ones about the best.

    The inertia force of a weight comes from the second difference of its sampled path, its torque from virtual power.
    """
    random, count = np.random.default_rng(5), 3000
    given = getattr(gk.forces(motion, loads), objective)
    q = motion.drive
    speed, gain, h = float(motion.timing.speed), float(motion.timing.acceleration), 1e-3
    near = [gk.move(motion.linkage, q + k * h) for k in (-1, 0, 1)]
    lowest, centre, width = np.inf, None, 1.0
    for _ in range(14):
        shape = (count, len(bodies), 3)
        if centre is None:
            shares = random.uniform(0, 1, shape)
        else:
            shares = centre + width * random.uniform(-0.5, 0.5, shape)
            shares[..., :2] = np.clip(shares[..., :2], 0, 1)
        values = np.zeros((count, len(q)), dtype=complex) + given
        for k, body in enumerate(bodies):
            mass = max_mass * shares[:, k, 0, None]
            arm = max_radius * shares[:, k, 1, None] * np.exp(2j * np.pi * shares[:, k, 2, None])
            pivot = 0 if body == "crank" else motion.linkage.bodies["ground"]["rocker_pivot"]
            paths = [pivot + arm * m.bodies[body].direction for m in near]
            first, second = (paths[2] - paths[0]) / (2 * h), (paths[2] - 2 * paths[1] + paths[0]) / h**2
            force = -1e-3 * mass * (second * speed**2 + first * gain)
            if objective == "shaking_force":
                values += force
            elif objective == "shaking_moment":
                values += (np.conj(paths[1]) * force).imag
            else:
                values += -(np.conj(force + 1e-3 * mass * loads.gravity) * first).real
        if objective == "driver":
            values -= values.mean(axis=1, keepdims=True)
        sizes = np.sqrt((np.abs(values) ** 2).mean(axis=1))
        if sizes.min() < lowest:
            lowest, centre = sizes.min(), shares[sizes.argmin()]
        width *= 0.6
    weights = [
        (body, max_mass * m, max_radius * r * np.exp(2j * np.pi * a))
        for body, (m, r, a) in zip(bodies, centre, strict=True)
    ]
    return rms(with_weights(motion, loads, weights), objective)


def test_a_weight_on_a_pivot_away_from_the_origin_of_its_body_is_placed_about_the_pivot():
    bodies = {"ground": {"O": 0}, "crank": {"O": 40 + 10j, "A": 90 + 10j}}
    motion = gk.move(gk.Linkage(bodies, "crank"), TURN, speed=10.0)
    loads = gk.Loads(masses={"crank": gk.Mass(0.3, 65 + 20j, 5)})
    weight = gk.balance(motion, loads, ["crank"], max_mass=2.0, max_radius=20.0).counterweights["crank"]
    assert weight.mass * (weight.centre - 40 - 10j) == pytest.approx(-0.3 * (25 + 10j))


def test_a_body_whose_counterweight_would_not_help_gets_none():
    """Without gravity a weight on the rocker only adds inertia to the drive, and one on a steady crank does nothing."""
    motion = gk.move(FOUR_BAR, TURN, speed=12.0)
    best = gk.balance(motion, gk.Loads(masses=BARS), ["crank", "rocker"], "driver", max_mass=1.0, max_radius=50.0)
    assert [weight.mass for weight in best.counterweights.values()] == [0, 0]


def test_gravity_alone_is_balanced_at_rest():
    motion = gk.move(FOUR_BAR, TURN, speed=0.0)
    best = gk.balance(motion, gk.Loads(-9810j, BARS), ["crank", "rocker"], "driver", max_mass=3.0, max_radius=60.0)
    assert best.rms_after < 1e-7 * best.rms_before


REFUSALS = [
    ({"bodies": ["coupler"]}, "bodies", "conflict"),
    ({"bodies": ["ground"]}, "bodies", "conflict"),
    ({"bodies": ["crank", "crank"]}, "bodies", "conflict"),
    ({"bodies": []}, "bodies", "conflict"),
    ({"bodies": ["lever"]}, "bodies", "unknown-key"),
    ({"motion": gk.move(FOUR_BAR, TURN, speed=0.0)}, "bodies", "conflict"),
    ({"motion": gk.move(gk.FourBar(100, 50, np.array([150.0, 151.0]), 111), TURN, speed=1.0)}, "motion", "wrong-type"),
    ({"objective": "driver", "loads": gk.Loads(masses=BARS, friction=[gk.PinFriction("crank_pin", 0.1, 2)])},
     "loads.friction", "conflict"),
    ({"max_radius": 1e-320}, "max_radius", "out-of-range"),
    ({"max_radius": 1e59}, "max_radius", "out-of-range"),
    ({"max_mass": 1e-320}, "max_mass", "out-of-range"),
]  # fmt: skip


@pytest.mark.parametrize("changed, field, id", REFUSALS)
def test_what_cannot_be_balanced_is_refused(changed, field, id):
    good = {"motion": gk.move(FOUR_BAR, TURN, speed=5.0), "loads": gk.Loads(masses=BARS), "bodies": ["crank"]}
    with pytest.raises(gk.DesignError) as refused:
        gk.balance(**good | {"max_mass": 1.0, "max_radius": 10.0} | changed)
    assert (refused.value.field, refused.value.id) == (field, id)
