"""A walker on its feet against statics, energy and motors of own formulas, from the lengths of its bars alone."""

import tomllib
from functools import cache
from itertools import combinations

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.measures import foot_shares, foot_slip

FRAMES = 1440
LEGS = [(0, False), (0, True), (180, False), (180, True), (0, False), (0, True)]
# Lower and upper faces of the six grounds, 3 mm thick, with the tubes between them that the steps name.
GROUNDS = np.cumsum([0, 3 + 54, 3 + 24, 3 + 60, 3 + 24, 3 + 60])
LAYER = {"ground": 0, "crank": 2, "triangle": 2, "leg": 2, "upper_rod": 3, "link": 3, "parallel": 3, "lower_rod": 5}
GRAVITY, SPEED = 9.81, 2 * np.pi
# Stall torque, N mm, speed, rpm, lasting torque, mass, kg, voltage and currents of the data sheets.
SHEETS = {"37d-50": (2059, 200, 514.75, 0.195, 12, 0.2, 5.5), "25d-75": (696, 75, 174, 0.1, 12, 0.06, 0.9),
          "n20-298": (196, 45, 49, 0.01, 6, 0.02, 0.36)}  # fmt: skip


@cache
def recipe():
    return gk.load("recipes/motor-walker.toml")


def table(**loads):
    table = tomllib.loads(gk.recipe.to_toml(recipe()))
    return {**table, "loads": {**table["loads"], **loads}}


def apex(one, other, to_one, to_other, side):
    """The point at two distances from two others, to the left of the line between them, or with side -1 to the right."""
    apart = np.abs(other - one)
    along = (apart**2 + to_one**2 - to_other**2) / (2 * apart)
    return one + (other - one) / apart * (along + 1j * side * np.sqrt(to_one**2 - along**2))


def leg(angle):
    """Each body's first point and a second one on its x axis, and the foot, of Jansen's leg with the crank at an angle."""
    o, f, m = 0 * angle + 0j, 0 * angle - 38 - 7.8j, 15 * np.exp(1j * angle)
    b = apex(m, f, 50, 41.5, -1)
    e = apex(m, f, 61.9, 39.3, 1)
    b, e = (b, e) if b[0].imag > e[0].imag else (apex(m, f, 50, 41.5, 1), apex(m, f, 61.9, 39.3, -1))
    d = apex(f, b, 40.1, 55.8, 1)
    g = apex(d, e, 39.4, 36.7, -1)
    bodies = {"ground": (o, o + 1), "crank": (o, m), "upper_rod": (m, b), "triangle": (f, b), "lower_rod": (m, e),
              "link": (f, e), "parallel": (d, g), "leg": (e, g)}  # fmt: skip
    return bodies, apex(e, g, 49, 65.7, 1)


def rate(values):
    """Central differences by time of values over a turn."""
    step = SPEED and 2 * np.pi / FRAMES / SPEED
    return (np.roll(values, -1, axis=-1) - np.roll(values, 1, axis=-1)) / (2 * step)


@cache
def statics(motor_mass):
    """Shares of the feet, their velocities, and the potential and kinetic energy of the moving bodies, N mm."""
    turn = np.linspace(0, 2 * np.pi, FRAMES, endpoint=False)
    masses = recipe().notes["masses"]
    feet, moment, mass, potential, kinetic = [], 0, 0.0, 0, 0
    for (phase, mirrored), start in zip(LEGS, GROUNDS):
        ahead = turn + np.radians(phase)
        bodies, foot = leg(np.pi - ahead if mirrored else ahead)
        across = {body: start + (3 - 3 * (k + 0.5) if mirrored else 3 * (k + 0.5)) for body, k in LAYER.items()}
        feet.append((-foot.conj() if mirrored else foot, across["leg"]))
        for body, (one, other) in bodies.items():
            own, direction = masses[body], (other - one) / np.abs(other - one)
            centre = one + direction * complex(*own["centre_mm"])
            turning = (rate(direction) * direction.conj()).imag
            potential = potential + own["mass_kg"] * GRAVITY * centre.imag * (body != "ground")
            kinetic = kinetic + 0.5e-3 * (
                own["mass_kg"] * np.abs(rate(centre)) ** 2 + own["inertia_kg_mm2"] * turning**2
            )
            x = -centre.real if mirrored else centre.real
            moment, mass = moment + own["mass_kg"] * (x + 1j * across[body]), mass + own["mass_kg"]
    # The pivots O and F of both sides are symmetric; the payload is there.
    middle = np.mean([side * x for _, turned in LEGS for side in [-1 if turned else 1] for x in (0, -38)])
    moment, mass = moment + 0.7 * (middle + 150j), mass + 0.7 + motor_mass
    feet, y = np.array([foot for foot, _ in feet]), np.array([across for _, across in feet])[:, None]
    centre = moment / mass
    points = np.stack([feet.real, y + 0 * feet.real, feet.imag], axis=-1)
    # The ground is the highest plane below all feet at the centre: the best of those through three feet.
    level, gap = np.full(FRAMES, -np.inf), np.zeros((6, FRAMES))
    for three in combinations(range(6), 3):
        a, b, c = points[list(three)]
        normal = np.cross(b - a, c - a)
        with np.errstate(all="ignore"):
            slope = -normal[:, :2] / normal[:, 2:]
            own_gap = points[..., 2] - a[:, 2] - np.einsum("kfi,fi->kf", points[..., :2] - a[:, :2], slope)
            at = a[:, 2] + (centre.real - a[:, 0]) * slope[:, 0] + (centre.imag - a[:, 1]) * slope[:, 1]
            better = (own_gap.min(axis=0) > -1e-7) & (at > level + 1e-9)
        level, gap = np.where(better, at, level), np.where(better, own_gap, gap)
    stands = gap < 1e-6
    rows = np.stack([np.ones(feet.shape), feet.real - centre.real, y - centre.imag]) * stands
    square = np.einsum("ikf,jkf->fij", rows, rows)
    shares = np.einsum("fi,ikf->kf", np.linalg.solve(square, np.array([[1.0], [0], [0]]))[..., 0], rows)
    assert shares.min() > -1e-9
    return shares, rate(feet), mass, potential, kinetic


def power(motor_mass, friction=0.5):
    """Power without inertia, and of the inertia, N mm/s: what friction takes, less what the ground gives, and energy."""
    shares, velocity, mass, potential, kinetic = statics(motor_mass)
    weight = mass * GRAVITY
    # The frame moves so that friction takes least.
    taken = np.min([(shares * np.abs(velocity.real - own)).sum(axis=0) for own in velocity.real], axis=0)
    # Central differences see a jump of the velocities of feet nowhere: they change smoothly.
    lifted = (shares * velocity.imag).sum(axis=0)
    return weight * (friction * taken - lifted) + rate(potential), rate(kinetic)


def test_feet_that_stand_share_the_weight_by_least_squares():
    """All subsets of six feet on level ground, of which the one with the least sum of squares counts."""
    rng = np.random.default_rng(3)
    feet = rng.normal(size=(6, 12)) + 1j * rng.normal(size=(6, 12))
    level, centre = np.zeros((6, 12)), 0.3 * rng.normal(size=12) + 0.2j * rng.normal(size=12)
    shares = foot_shares(feet, level, centre, np.zeros(12, dtype=complex))
    for own, place, middle in zip(shares.T, feet.T, centre):
        equations = np.stack([np.ones(6), (place - middle).real, (place - middle).imag])
        best = np.full(6, np.inf)
        for count in (3, 4, 5, 6):
            for subset in map(list, combinations(range(6), count)):
                force = np.zeros(6)
                force[subset] = np.linalg.lstsq(equations[:, subset], [1, 0, 0], rcond=None)[0]
                if force.min() > -1e-9 and np.abs(equations @ force - [1, 0, 0]).max() < 1e-9:
                    best = min(best, force, key=lambda f: (f**2).sum())
        if np.isfinite(best).all():
            assert own == pytest.approx(best, abs=1e-2) and (own**2).sum() < 1.02 * (best**2).sum()


def test_frame_slides_at_the_speed_at_which_friction_takes_least():
    rng = np.random.default_rng(4)
    shares, velocity = rng.dirichlet(np.ones(5), size=20).T, rng.normal(size=(5, 20))
    sense, frame = foot_slip(shares, velocity)
    assert sense.sum(axis=0) == pytest.approx(0, abs=1e-12) and (np.abs(sense) <= shares + 1e-12).all()
    trials = np.linspace(-3, 3, 2001)[:, None, None]
    least = (shares * np.abs(velocity + trials)).sum(axis=1).min(axis=0)
    assert (shares * np.abs(velocity + frame)).sum(axis=0) == pytest.approx(least, abs=2e-3)
    assert -(sense * velocity).sum(axis=0) == pytest.approx(least, abs=2e-3)


@pytest.mark.campaign
def test_feet_of_the_walker_carry_what_statics_gives():
    shares, velocity, mass, *_ = statics(0.195)
    stance = recipe().aspect("foot").stance
    assert stance.mass == pytest.approx(mass, rel=1e-6)
    every = FRAMES // (stance.shares.shape[1] - 1)
    ours, theirs = stance.shares[:, :-1], shares[:, ::every]
    # In a frame where another foot takes over, either may carry.
    same = np.abs(ours - theirs).max(axis=0) < 1e-3
    assert same.mean() > 0.95
    assert stance.velocity[:, :-1] == pytest.approx(velocity.real[:, ::every], abs=1e-3 * np.abs(velocity).max())
    columns = [recipe().table[f"foot_{k}_load"] for k in range(1, 7)]
    assert np.sum(columns, axis=0) == pytest.approx(mass * GRAVITY, rel=1e-6)


def test_torque_of_the_walker_is_the_power_of_friction_weight_and_inertia():
    still, inertia = power(0.195)
    torque = (still + inertia)[:: FRAMES // 90] / SPEED
    ours = recipe().table["shaft_torque"][:-1]
    assert (np.abs(ours - torque) < 0.02 * np.abs(torque).max()).mean() > 0.95
    work = np.mean(still + inertia)
    shares, velocity, mass, *_ = statics(0.195)
    slid = np.min([(shares * np.abs(velocity.real - own)).sum(axis=0) for own in velocity.real], axis=0)
    # Over a turn only friction takes work.
    assert work == pytest.approx(0.5 * mass * GRAVITY * slid.mean(), rel=0.01)


@pytest.mark.parametrize("name", SHEETS)
def test_motors_walk_as_their_data_sheets_and_statics_say(name):
    stall, no_load_rpm, lasting, mass, voltage, idle, stall_current = SHEETS[name]
    still, inertia = (values / SPEED for values in power(mass))
    entry = next(entry for entry in recipe().notes["loads"]["motors"] if entry["motor"] == name)

    def margin(rpm):
        torque = still + inertia * (rpm / 60) ** 2
        left = max(0.0, stall * (1 - rpm / no_load_rpm))
        return min(left / np.abs(torque).max(), lasting / np.sqrt(np.mean(torque**2))) if left else 0.0

    assert entry["margin"] == pytest.approx(margin(60), rel=0.02) and entry["suffices"] == (margin(60) >= 1.5)
    speeds = np.linspace(0.01, no_load_rpm, 4000)
    largest = speeds[np.argmax([margin(rpm) < 1.5 for rpm in speeds])]
    assert entry["largest_speed_rpm"] == pytest.approx(largest, rel=0.01)
    shares, velocity, *_ = statics(mass)
    frame = [
        -v[np.argmin((s[:, None] * np.abs(v[:, None] - v)).sum(axis=0))] for s, v in zip(shares.T, velocity.real.T)
    ]
    step = abs(np.mean(frame))
    assert entry["largest_walking_speed_mm_per_s"] == pytest.approx(step * largest / 60, rel=0.02)
    if not entry["suffices"]:
        assert "battery_h" not in entry
        return
    current = idle + (stall_current - idle) * (still + inertia) / stall
    resistance = voltage / stall_current
    volts = resistance * current + (voltage - resistance * idle) * 60 / no_load_rpm
    watts = np.mean(np.where(current > 0, np.maximum(volts, 0) * current, 0))
    assert entry["battery_h"] == pytest.approx(24 / watts, rel=0.02)


@pytest.mark.campaign
def test_a_battery_beyond_the_feet_tips_the_walker_and_the_advice_sets_it_up_again():
    """0.7 kg beyond the end of the shaft, at the place that the check suggests."""

    def placed(x, y):
        carried = [{"mass_kg": 0.1}, {"mass_kg": 0.7, "along": x, "across": y}]
        own = table(carried=carried, motors=[])
        del own["loads"]["battery_wh"]
        return gk.load(own | {"drive": {"step_deg": 10}})

    tipping = placed(10, 300)
    assert tipping.aspect("foot").stance.least_margin[0] < 0 and not tipping.aspect("loads").walking
    check = next(check for check in tipping.design_checks if check.id == "support_margin")
    assert not check.passed and 0 <= check.at <= 360
    (suggestion,) = check.suggestions
    standing = placed(*(suggestion.values[f"loads.carried[1].{key}"] for key in ("along", "across")))
    assert standing.aspect("foot").stance.least_margin[0] > 0 and standing.aspect("loads").walking


@pytest.mark.parametrize(
    ("loads", "key"),
    [({"carried": [{"mass_kg": 1}]}, "loads.carried"), ({"foot_friction": 0.3}, "loads.foot_friction"),
     ({"battery_wh": 10}, "loads.battery_wh"), ({"motors": 7 * ["tt"]}, "loads.motors")],
)  # fmt: skip
def test_keys_of_a_walker_are_refused_where_they_mean_nothing(loads, key):
    bar = {"kind": "four-bar", "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}}
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({**bar, "loads": {"masses": {"rocker": {"mass_kg": 1}}, **loads}})
    assert [problem.key for problem in refused.value.problems] == [key]
