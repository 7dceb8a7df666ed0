"""Loads of a linkage: springs against their energy, friction against the power it takes, and what is refused."""

import numpy as np
import pytest

import geomkin as gk

TURN = np.linspace(0, 2 * np.pi, 73)
SLIDER_CRANK = gk.SliderCrank(30, 90, 12, 40 + 5j)


def length(motion, body, place, other):
    return abs(motion[body].point(place).position - other)


# Load, and its potential energy at a motion, N mm.
CONSERVATIVE = {
    "weight": (
        gk.Loads(-9810j, {"coupler": gk.Mass(0.5, 30 + 8j, 900.0)}),
        lambda motion: 0.5 * 9.81 * motion["coupler"].point(30 + 8j).position.imag,
    ),
    "spring": (
        gk.Loads(springs=[gk.Spring("coupler", "coupler_point", "ground", 200 + 90j, 2.5, 60.0, -7.0)]),
        lambda m: 1.25 * (length(m, "coupler", 40 + 5j, 200 + 90j) - 60) ** 2 - 7 * length(m, "coupler", 40 + 5j, 200 + 90j),
    ),
    "gas spring": (
        gk.Loads(springs=[gk.GasSpring("slider", "slider_pin", "ground", 300j, 80.0, 400.0, 600.0)]),
        lambda m: -80 * 600 * np.log(1 - (400 - length(m, "slider", 0, 300j)) / 600),
    ),
    "torsion spring": (
        gk.Loads(springs=[gk.TorsionSpring("coupler", "crank", 150.0, 20.0, 40.0)]),
        lambda m: 75 * twist(m) ** 2 - 40 * twist(m),
    ),
    "slide force": (
        gk.Loads(slide_forces=[gk.SlideForce("slide", 15.0)]),
        lambda m: -15 * m.slide("slide").displacement,
    ),
    "turning torque": (gk.Loads(torques=[gk.Torque("coupler", 33.0)]), lambda m: -33 * np.angle(m["coupler"].direction)),
}  # fmt: skip


def twist(motion):
    return np.unwrap(np.angle(motion["coupler"].direction / motion["crank"].direction / np.exp(1j * np.radians(20))))


@pytest.mark.parametrize("load", CONSERVATIVE)
def test_driver_is_the_slope_of_the_energy(load):
    loads, energy = CONSERVATIVE[load]
    driver = gk.forces(gk.move(SLIDER_CRANK, TURN[:70], speed=0.0), loads).driver
    step = 1e-4
    after, before = (energy(gk.move(SLIDER_CRANK, TURN[:70] + side)) for side in (step, -step))
    np.testing.assert_allclose(driver, (after - before) / (2 * step), atol=1e-4 * abs(driver).max())


def test_conservative_loads_take_no_work_over_a_turn():
    springs = [gk.Spring("coupler", "coupler_point", "ground", 200 + 90j, 2.5, 60.0)]
    loads = gk.Loads(-9810j, {"coupler": gk.Mass(0.5, 30 + 8j, 900.0), "slider": gk.Mass(1.0)}, springs=springs)
    result = gk.forces(gk.move(SLIDER_CRANK, TURN, speed=20.0), loads)
    assert abs(result.work) < 1e-9 * np.abs(result.driver).max()


def test_force_that_turns_with_its_body():
    motion = gk.move(SLIDER_CRANK, TURN)
    turning = gk.forces(motion, gk.Loads(forces=[gk.Force("coupler", 40 + 5j, 3 + 4j, "body")]))
    fixed = gk.forces(
        motion, gk.Loads(forces=[gk.Force("coupler", "coupler_point", (3 + 4j) * motion["coupler"].direction)])
    )
    np.testing.assert_allclose(turning.driver, fixed.driver, rtol=1e-13)


def test_table_of_a_load_over_the_drive():
    table = gk.DriveTable([0.0, 1.0, 1.0, 4.0], [0.0, 10.0, -5.0, -5.0], period=2 * np.pi)
    np.testing.assert_allclose(table.at(np.array([0.5, 2.0, 4.0 + 2 * np.pi])), [5.0, -5.0, -5.0])
    # From its last row it leads to the first of the next turn.
    assert table.at(np.array([0.5 * (4 + 2 * np.pi)])) == pytest.approx(-2.5)
    once = gk.DriveTable([0.0, 1.0], [2.0, 3.0])
    np.testing.assert_allclose(once.at(np.array([-5.0, 9.0])), [2.0, 3.0])


def test_linkages_at_once_give_the_results_of_each():
    rockers = np.array([70.0, 75.0, 81.0])
    loads = gk.Loads(-9810j, {"coupler": gk.Mass(0.5, 45, 350.0)}, friction=[gk.PinFriction("crank_pin", 0.2, 4.0)])
    both = gk.forces(gk.move(gk.FourBar(100, 30, 90, rockers), TURN, speed=5.0), loads)
    for k, rocker in enumerate(rockers):
        single = gk.forces(gk.move(gk.FourBar(100, 30, 90, rocker), TURN, speed=5.0), loads)
        np.testing.assert_allclose(both.driver[:, k], single.driver, rtol=1e-11)
        np.testing.assert_allclose(both.pin("rocker_pin", "rocker")[:, k], single.pin("rocker_pin", "rocker"), 1e-9)
        np.testing.assert_allclose(both.shaking_moment[:, k], single.shaking_moment, 1e-9, 1e-9)


def test_joint_forces_are_unknown_at_a_dead_centre():
    """A slider that pushes a crank: at the ends of its stroke no force of the slider holds a torque on the crank."""
    linkage = gk.SliderCrank(30, 90, driver="slider")
    loads = gk.Loads(torques=[gk.Torque("crank", 100.0)])
    result = gk.forces(gk.move(linkage, [119.9999, 120.0, 121.0], speed=0.0), loads)
    assert np.isfinite(result.driver[0]) and np.isnan(result.driver[1:]).all()
    assert np.isnan(result.pin("crank_pin", on="coupler")[1:]).all()
    assert result.condition[0] > 1e3


PIN_FRICTION = [gk.PinFriction(pin, 0.15, 4.0, 20.0) for pin in ("crank_pivot", "crank_pin", "slider_pin")]


def test_friction_takes_what_the_driver_gives_more():
    loads = gk.Loads(
        -9810j,
        {"coupler": gk.Mass(0.5, 30 + 8j, 900.0), "slider": gk.Mass(1.0)},
        [gk.Force("slider", 5.0, -60.0)],
        friction=[*PIN_FRICTION, gk.SlideFriction("slide", 0.12, 40.0, 0.1)],
    )
    motion = gk.move(SLIDER_CRANK, TURN, speed=-20.0)
    result, smooth = gk.forces(motion, loads), gk.forces(motion, gk.Loads(-9810j, loads.masses, loads.forces))
    slide, lost = result.slide("slide"), 0.0
    for friction in PIN_FRICTION:
        holder, body = motion.linkage.pins[friction.pin]
        slip = abs(motion[body].omega - motion[holder].omega)
        lost += 4 * np.sin(np.arctan(0.15)) * abs(result.pin(friction.pin, on=body)) * slip + 20 * slip**2
    sliding = abs(motion.slide("slide").velocity)
    # The two ends of the guided part, 20 mm from its middle.
    ends = [slide.normal / 2 + side * slide.moment / 40.0 for side in (1, -1)]
    lost += 0.12 * (abs(ends[0]) + abs(ends[1])) * sliding + 0.1 * sliding**2
    np.testing.assert_allclose(result.friction_power, 1e-3 * lost, rtol=1e-9)
    np.testing.assert_allclose(result.power - smooth.power, 1e-3 * lost, rtol=1e-9)


def test_efficiency_is_the_useful_share_of_the_work():
    motion = gk.move(SLIDER_CRANK, TURN, speed=20.0)
    velocity = motion.slide("slide").velocity
    against = [gk.Force("slider", 0j, -60.0 * np.sign(velocity))]
    result = gk.forces(motion, gk.Loads(forces=against, friction=PIN_FRICTION))
    useful = np.trapezoid(60 * abs(velocity), motion.drive / 20)
    assert result.efficiency == pytest.approx(useful / result.work, rel=1e-12)
    assert result.work == pytest.approx(1000 * np.trapezoid(result.power, motion.drive / 20), rel=1e-12)


@pytest.mark.parametrize("speed", [20.0, -20.0])
@pytest.mark.parametrize("pin", [0.0, 0.1])
def test_efficiency_of_an_engine_is_the_work_of_its_shaft_over_that_of_its_gas(pin, speed):
    motion = gk.move(gk.SliderCrank(40, 140), np.linspace(0, np.sign(speed) * 2 * np.pi, 721), speed=speed)
    slide, inwards = motion.slide("slide"), np.arange(721) <= 360
    friction = [gk.SlideFriction("slide", coefficient=0.1), gk.PinFriction("crank_pin", coefficient=pin, radius=5)]
    result = gk.forces(
        motion, gk.Loads(forces=[gk.Force("slider", force=np.where(inwards, -250.0, 0.0))], friction=friction)
    )
    # The gas acts over the whole stroke of 80 mm; the shaft receives what friction leaves.
    gas, lost = 250 * 80, np.trapezoid(result.friction_power, motion.drive / speed) * 1000
    assert result.efficiency == pytest.approx((gas - lost) / gas, rel=1e-4)
    assert 0.9 < result.efficiency < 0.98 and np.ptp(slide.displacement) == pytest.approx(80)


def test_efficiency_is_unknown_if_nothing_is_taken_out():
    motion = gk.move(SLIDER_CRANK, TURN, speed=20.0)
    weights = {"coupler": gk.Mass(0.5, 30 + 8j, 900.0)}
    assert np.isnan(gk.forces(motion, gk.Loads(-9810j, weights, friction=PIN_FRICTION)).efficiency)
    assert np.isnan(gk.forces(motion, gk.Loads(-9810j, weights)).efficiency)
    # A load that friction holds back: the driver has to help it.
    stuck = [gk.PinFriction("crank_pivot", 5.0, 100.0)]
    load = gk.Loads(forces=[gk.Force("slider", 0j, 60.0 * np.sign(motion.slide("slide").velocity))], friction=stuck)
    result = gk.forces(motion, load)
    assert result.work > 0 and np.isnan(result.efficiency)


def test_friction_locks_near_a_dead_centre():
    """A rocker that drives the crank of a four-bar: friction grows without limit, and 1.2 deg before it locks."""
    linkage = gk.FourBar(100, 50, 151, 111, driver="rocker")
    crank = gk.FourBar(100, 50, 151, 111)
    stretched = np.arccos((100**2 + 201**2 - 111**2) / (2 * 100 * 201))
    gaps = np.radians([20.0, 5.0, 2.0, 0.5, 0.05])
    rocker = np.angle(gk.move(crank, stretched + gaps)["rocker"].direction)
    loads = gk.Loads(
        torques=[gk.Torque("crank", -500.0)], friction=[gk.PinFriction(p, 0.15, 4.0) for p in crank.linkage.pins]
    )
    results = [gk.forces(gk.move(linkage, [q], branch=b, speed=1.0), loads) for q in rocker for b in (1, -1)]
    near = [result for result in results if abs(np.exp(1j * stretched) - result.motion["crank"].direction[0]) < 0.4]
    assert any(np.isfinite(result.driver).all() for result in near)
    assert any(result.self_locking.all() for result in near)


WRONG = {
    "masses": lambda: gk.Loads(masses={"crnk": gk.Mass(1.0)}),
    "forces.body": lambda: gk.Loads(forces=[gk.Force("crnk")]),
    "forces.point": lambda: gk.Loads(forces=[gk.Force("crank", "nose")]),
    "forces.force": lambda: gk.Loads(forces=[gk.Force("crank", 0, np.ones(5))]),
    "torques.body": lambda: gk.Loads(torques=[gk.Torque("crnk")]),
    "torques.torque": lambda: gk.Loads(torques=[gk.Torque("crank", 1j)]),
    "slide_forces.slide": lambda: gk.Loads(slide_forces=[gk.SlideForce("rail")]),
    "springs": lambda: gk.Loads(springs=[gk.Spring("crank", "crank_pin", "coupler", "crank_pin", 1.0)]),
    "springs.to_body": lambda: gk.Loads(springs=[gk.Spring("crank", 0, "crank", 5)]),
    "springs.gas_length": lambda: gk.Loads(springs=[gk.GasSpring("slider", 0, "ground", 0, 9.0, 400.0, 5.0)]),
    "friction.pin": lambda: gk.Loads(friction=[gk.PinFriction("pin")]),
    "friction.slide": lambda: gk.Loads(friction=[gk.SlideFriction("rail")]),
}


@pytest.mark.parametrize("field", WRONG)
def test_loads_that_do_not_fit_the_linkage_are_refused(field):
    motion = gk.move(SLIDER_CRANK, TURN)
    with pytest.raises(gk.DesignError) as error:
        gk.forces(motion, WRONG[field]())
    assert error.value.field == field


@pytest.mark.parametrize("wrong", [lambda r: r.pin("pin", "crank"), lambda r: r.pin("crank_pin", "slider"), lambda r: r.slide("x")])  # fmt: skip
def test_unknown_joints_are_refused(wrong):
    with pytest.raises(gk.DesignError):
        wrong(gk.forces(gk.move(SLIDER_CRANK, TURN), gk.Loads()))
