"""Derivatives of motions by sizes, against differences of motions and against 40 digits."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.sensitivity import quantities, size_names
from tests.campaign import by_default
from tests.linkage.examples import ALL, FOUR_BAR

TIMING = {"speed": 1.5, "acceleration": 0.7}
# Of the central difference of order four, in mm or rad, for linkages of about 100 mm.
STEP = {"": 2e-3, "_deg": 2e-5}


def changed(linkage, name, step):
    """The general linkage with one of its sizes changed; a second implementation of the names of sizes."""
    general = linkage.linkage
    *path, last = name.split(".")
    delta = {"x": step, "y": 1j * step}.get(last, np.degrees(step))
    path = path if last in "xy" else [*path, last]
    if len(path) == 1:
        return replace(general, **{path[0]: getattr(general, path[0]) + delta})
    owner, field = path
    if owner in general.bodies:
        points = {**general.bodies[owner], field: general.bodies[owner][field] + delta}
        return replace(general, bodies={**general.bodies, owner: points})
    sliders = [s if s.name != owner else replace(s, **{field: getattr(s, field) + delta}) for s in general.sliders]
    return replace(general, sliders=tuple(sliders))


def value(motion, id):
    """A quantity as the motion itself reports it; the index is that of its time derivative."""
    if id == "transmission_angle":
        return motion.transmission_angle
    for k, (turning, sliding, suffix) in enumerate(
        [("angle", "displacement", ""), ("omega", "velocity", "_velocity"), ("alpha", "acceleration", "_acceleration")]
    ):
        for body in motion.linkage.bodies:
            if id == f"{body}_{turning}":
                moved = motion.bodies[body]
                return (np.unwrap(np.angle(moved.direction), axis=0), moved.omega, moved.alpha)[k]
        for slider in motion.linkage.sliders:
            if id == f"{slider.name}_{sliding}":
                return getattr(motion.slide(slider.name), sliding)
        for point in {p for points in motion.linkage.bodies.values() for p in points}:
            for part in ("", "_x", "_y"):
                if id == f"{point}{suffix}{part}":
                    z = getattr(motion.point(point), ("position", "velocity", "acceleration")[k])
                    return {"": z, "_x": z.real, "_y": z.imag}[part]
    raise KeyError(id)


def differences(make, drive, branch, step):
    """A function from the id of a quantity to its central difference of order four."""
    motions = [gk.move(make(k * step), drive, branch, **TIMING) for k in (2, 1, -1, -2)]
    weights = np.array([-1, 8, -8, 1]) / (12 * step)
    return lambda id: sum(w * value(motion, id) for w, motion in zip(weights, motions))


def close(one, other):
    scale = np.nanmax(np.abs(other), initial=1.0)
    assert np.array_equal(np.isnan(one), np.isnan(other)) and np.nanmax(np.abs(one - other), initial=0) <= 2e-7 * scale


# Loops that are solved together have no derivative of their transmission angle.
LOOPS = ("loops", "actuator between moving bars")


@pytest.mark.parametrize("name", by_default(ALL, slice(0, None, 5)))
def test_derivatives_of_all_linkages_are_those_of_differences(name):
    linkage, drive, branch = ALL[name]
    drive, rng = drive[3:-1:9], np.random.default_rng(len(name))
    motion = gk.move(linkage, drive, branch, **TIMING)
    names, ids = size_names(linkage.linkage), list(quantities(motion.linkage))
    cases = [*zip(rng.choice(ids, 4, replace=False), rng.choice(names, 4)), ("transmission_angle", rng.choice(names))]
    for of, by in cases:
        if name in LOOPS and of == "transmission_angle":
            assert np.isnan(motion.sensitivity(of, by)).all()
            continue
        step = STEP["_deg" if by.endswith("_deg") else ""]
        expected = differences(lambda s, by=by: changed(linkage, by, s), drive, branch, step)(of)
        # An angle that stays at 90 deg is folded there.
        folded = (of == "transmission_angle") & (motion.transmission_angle > 0.5 * np.pi - 1e-12)
        close(motion.sensitivity(of, by), np.where(folded, np.nan, expected))


@pytest.mark.parametrize(
    ("linkage", "by"),
    [
        (FOUR_BAR, "rocker"),
        (FOUR_BAR, "coupler_point.y"),
        (FOUR_BAR, "ground_angle_deg"),
        (replace(FOUR_BAR, driver="coupler", crank=90.0, coupler=32.0), "crank"),
        (gk.StephensonSixBar(FOUR_BAR, 80, 60, 60 + 120j), "four_bar.crank"),
        (gk.WattSixBar(FOUR_BAR, 50 - 30j, 90, 60, 180), "rocker_point.x"),
        (gk.linkage.Pantograph(150, 140, 3, 10, 60 + 0j), "ratio"),
        (gk.ScotchYoke(30, 100, 70), "slot_deg"),
        (gk.Shaper(90, 30, 180, 60, 85), "ram_height"),
    ],
)
def test_derivatives_by_the_sizes_of_named_linkages(linkage, by):
    drive, (name, _, axis) = np.linspace(0.2, 1.2, 4), by.partition(".")

    def make(step):
        if by == "four_bar.crank":
            return replace(linkage, four_bar=replace(FOUR_BAR, crank=FOUR_BAR.crank + step))
        delta = np.degrees(step) if by.endswith("_deg") else 1j * step if axis == "y" else step
        return replace(linkage, **{name: getattr(linkage, name) + delta})

    motion = gk.move(linkage, drive, **TIMING)
    expected = differences(make, drive, 1, STEP["_deg" if by.endswith("_deg") or by == "ratio" else ""])
    for of in quantities(motion.linkage):
        folded = (of == "transmission_angle") & (motion.transmission_angle > 0.5 * np.pi - 1e-12)
        close(motion.sensitivity(of, by), np.where(folded, np.nan, expected(of)))


def test_many_linkages_and_many_frames_have_the_derivatives_of_each_alone():
    rng = np.random.default_rng(2)
    # The third four-bar cannot be assembled at all positions of its crank, the last one nowhere.
    lengths = [np.append(v + 5 * rng.random(5), w) for v, w in zip((100, 30, 90, 70), (100, 30, 40, 20))]
    lengths[1][2] = 65
    many = gk.FourBar(*lengths, coupler_point=40 + 25j)
    drive = np.linspace(0, 6, 1000)
    motion = gk.move(many, drive, **TIMING)
    assert not motion.assembled[:, 2].all() and motion.assembled[:, 2].any() and not motion.assembled[:, 5].any()
    for of in ("coupler_point_acceleration", "transmission_angle"):
        rates = motion.sensitivity(of, by="coupler")
        assert rates.shape == (1000, 6)
        assert np.array_equal(np.isnan(rates), ~motion.assembled)
        for k in range(5):
            alone = gk.move(gk.FourBar(*(v[k] for v in lengths), coupler_point=40 + 25j), drive[::50], **TIMING)
            one = alone.sensitivity(of, by="coupler")
            np.testing.assert_allclose(rates[::50, k], one, rtol=1e-9, atol=1e-12 * np.nanmax(np.abs(one)))
    few = gk.move(many, drive[::250], **TIMING)
    for by in ("crank", "coupler_point.y", "origin.x", "ground_angle_deg"):
        rates = few.sensitivity("coupler_point_velocity", by=by)
        for k in range(5):
            alone = gk.move(gk.FourBar(*(v[k] for v in lengths), coupler_point=40 + 25j), drive[::250], **TIMING)
            one = alone.sensitivity("coupler_point_velocity", by=by)
            np.testing.assert_allclose(rates[:, k], one, rtol=1e-9, atol=1e-10)
    long = np.linspace(0, 6, 9000)
    rates = gk.move(FOUR_BAR, long).sensitivity("coupler_point", by="crank")
    np.testing.assert_allclose(rates[::100], gk.move(FOUR_BAR, long[::100]).sensitivity("coupler_point", by="crank"))


def exact(sizes, point, angle):
    """Coupler point, its first and second derivative by the crank, and rocker angle, of a four-bar in high precision."""
    d, a, b, c = sizes

    def pose(t):
        u = d - a * mp.expj(t)
        s = abs(u) ** 2
        p = (s + b**2 - c**2) / (2 * s)
        bar = u * (p + 1j * mp.sqrt(b**2 / s - p**2))
        return a * mp.expj(t) + bar * point / b, mp.arg((bar - u) / c)

    return [mp.diff(lambda t: pose(t)[0], angle, k) for k in (0, 1, 2)] + [pose(angle)[1]]


@pytest.mark.parametrize(
    ("sizes", "angle"),
    [
        ((100, 30, 90, 70), 1.0),
        # 1e-4 mm from a toggle, and from a change point.
        ((3, 1, 3.9999, 2), 0.001),
        ((100, 40, 100.0001, 40), 3.14),
        ((100, 80, 60, 70), 1.2),
    ],
)
def test_derivatives_keep_their_digits_near_toggles_and_change_points(sizes, angle):
    motion = gk.move(gk.FourBar(*sizes, coupler_point=2 + 1j), [angle])
    condition = motion.error_amplification[0]
    assert condition > 10 or sizes[1] in (30, 80)
    with mp.workdps(60):
        for k, by in enumerate(("ground", "crank", "coupler", "rocker")):

            def moved(size, k=k):
                changed = [mp.mpf(size if j == k else v) for j, v in enumerate(sizes)]
                return exact(changed, mp.mpc(2, 1), mp.mpf(angle))

            step = mp.mpf(10) ** -15
            above, below = moved(sizes[k] + step), moved(sizes[k] - step)
            expected = [complex((x - y) / (2 * step)) for x, y in zip(above, below)]
            ids = "coupler_point", "coupler_point_velocity", "coupler_point_acceleration", "rocker_angle"
            for order, (of, true) in enumerate(zip(ids, expected)):
                # A derivative by a size and k by the drive grows with the power 2 k + 1 of the condition at a toggle.
                got = motion.sensitivity(of, by)[0]
                assert abs(got - true) <= 2e-14 * condition * abs(true) + 1e-13, (by, of, order)


def test_a_limit_of_the_driver_and_a_change_point_have_no_derivative():
    low, high = gk.driver_limits(gk.FourBar(4, 3, 2, 2), span=(-3.0, 3.0))[0]
    motion = gk.move(gk.FourBar(4, 3, 2, 2), [low, high, 0.1 * low, high + 0.1])
    rates = motion.sensitivity("rocker_angle", by="crank")
    assert np.isfinite(rates[2]) and np.isnan(rates[3])
    assert (np.isnan(rates[:2]) | (np.abs(rates[:2]) > 1e5)).all()
    motion = gk.move(gk.FourBar(100, 40, 100, 40, 40 + 25j), [0.0, 1.0], "follow")
    assert np.isnan(motion.sensitivity("coupler_point", by="crank")[0])
    assert np.isfinite(motion.sensitivity("coupler_point", by="crank")[1])
    # The crank pin is on the crank, whose angle is given.
    np.testing.assert_allclose(motion.sensitivity("crank_pin", by="crank"), motion.crank.direction, rtol=1e-15)


@pytest.mark.parametrize(
    ("of", "by", "field", "nearest"),
    [
        ("coupler_pont", "crank", "of", "coupler_point"),
        ("coupler_point", "cranc", "by", "crank"),
        ("coupler_point", "driver", "by", "crank"),
        ("coupler_point", "coupler_point", "by", "coupler_point.x"),
    ],
)
def test_unknown_quantities_and_sizes_name_the_nearest(of, by, field, nearest):
    with pytest.raises(gk.DesignError) as caught:
        gk.move(FOUR_BAR, [0.0]).sensitivity(of, by)
    assert (caught.value.field, caught.value.id) == (field, "unknown-key")
    assert nearest in caught.value.remedy or by == "driver"


@pytest.mark.parametrize("size", ["ground", "crank", "coupler", "rocker"])
def test_limits_of_the_driver_and_dead_centres_follow_by_implicit_differentiation(size):
    """The limit is the extreme of the driver's angle when the rocker drives; at a dead centre the rocker stands still."""
    step = 1e-5

    def slope(limits, linkage):
        return (limits(_with(linkage, size, step)) - limits(_with(linkage, size, -step))) / (2 * step)

    linkage = gk.FourBar(60, 50, 40, 45)
    limit = gk.driver_limits(linkage)[0][1]
    rocker = np.angle(gk.move(linkage, [limit]).rocker.direction)
    driven = gk.move(replace(linkage, driver="rocker"), rocker)
    assert driven.crank.direction[0] == pytest.approx(np.exp(1j * limit), abs=1e-9)
    by_difference = slope(lambda linkage: gk.driver_limits(linkage)[0][1], linkage)
    assert driven.sensitivity("crank_angle", by=size)[0] == pytest.approx(by_difference, abs=1e-6)

    linkage = gk.FourBar(100, 30, 90, 70)
    ends = gk.move(linkage, gk.linkage.dead_centres(linkage, "rocker"))
    by_difference = slope(lambda linkage: np.array(gk.linkage.dead_centres(linkage, "rocker")), linkage)
    by_implicit = -ends.sensitivity("rocker_omega", by=size) / ends.rocker.second
    np.testing.assert_allclose(by_implicit, by_difference, atol=1e-7)


def _with(linkage, size, step):
    return replace(linkage, **{size: getattr(linkage, size) + step})
