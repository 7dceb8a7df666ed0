"""The motion that follows from a torque: closed forms, elliptic integrals and a published mechanism."""

import numpy as np
import pytest

import geomkin as gk
from tests.linkage import andrews

TURN = np.linspace(0, 2 * np.pi, 721)
CRANK = gk.move(gk.Linkage({"ground": {"O": 0j}, "crank": {"O": 0j, "A": 100}}, "crank"), TURN)
PENDULUM = gk.Loads(-9810j, {"crank": gk.Mass(2.0, 100, 0)})


def agm(a, b):
    """The arithmetic-geometric mean: K(k) = pi / 2 / agm(1, sqrt(1 - k2))."""
    for _ in range(40):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return a


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.8])
def test_a_pendulum_swings_with_the_period_of_the_elliptic_integral(amplitude):
    """T = 2 pi sqrt(l / g) / agm(1, cos(amplitude / 2)); released, it is at rest again after half of it."""
    period = 2 * np.pi * np.sqrt(100 / 9810) / agm(1.0, np.cos(amplitude / 2))
    start = -np.pi / 2 + amplitude
    motion = gk.forward_dynamics(CRANK, PENDULUM, duration=period, steps=2000, start=start)
    assert motion.drive[[1000, 2000]] == pytest.approx([-np.pi / 2 - amplitude, start], abs=1e-7)
    assert motion.speed[[1000, 2000]] == pytest.approx([0, 0], abs=1e-6 * np.abs(motion.speed).max())
    assert motion.energy_error < 1e-7


def test_a_motor_runs_up_a_flywheel_exponentially_and_viscous_friction_stops_it():
    motor = gk.Motor("own", torque_n_mm=500, speed_rpm=120, lasting_torque_n_mm=1, mass_g=1)
    wheel, free = {"crank": gk.Mass(0.0, 0, 4e5)}, 4 * np.pi
    result = gk.forward_dynamics(CRANK, gk.Loads(masses=wheel), motor, duration=30, steps=1000)
    # T = T0 (1 - w / w0) on an inertia of 400 N mm s2.
    assert result.speed == pytest.approx(free * (1 - np.exp(-500 / free / 400 * result.time)), rel=1e-8, abs=1e-8)
    assert result.energy_error < 1e-8
    friction = gk.Loads(masses=wheel, friction=[gk.PinFriction("O", viscous=50)])
    result = gk.forward_dynamics(CRANK, friction, speed=-3.0, duration=20, steps=1000)
    assert result.speed == pytest.approx(-3 * np.exp(-50 / 400 * result.time), rel=1e-8)


def test_a_linkage_keeps_its_energy_and_its_forces_return_the_torque():
    """Kinetic energy from the velocities of all bodies, and the torque by inverse dynamics of the motion."""
    linkage = gk.FourBar(100, 30, 90, 70)
    masses = {name: gk.Mass(0.3, 20 + 5j, 150) for name in ("crank", "coupler", "rocker")}
    spring = gk.Spring("rocker", "rocker_pin", "ground", 40 + 90j, stiffness=0.1)
    loads = gk.Loads(-9810j, masses, springs=[spring])
    turn = gk.move(linkage, TURN)
    result = gk.forward_dynamics(
        turn, loads, lambda drive, speed: 400 - 10 * speed, speed=20.0, duration=1.5, steps=3000
    )
    motion = result.motion
    assert result.drive[-1] > 4 * np.pi
    energy = sum(
        (m.mass * np.abs(motion.bodies[b].point(m.centre).velocity) ** 2 + m.inertia * motion.bodies[b].omega ** 2)
        / 2000
        for b, m in masses.items()
    )
    assert result.kinetic_energy == pytest.approx(energy, rel=1e-7)
    assert result.energy_error < 1e-7
    wanted = 400 - 10 * result.speed
    assert gk.forces(motion, loads).driver == pytest.approx(wanted, abs=1e-5 * np.abs(wanted).max())
    assert np.gradient(result.drive, result.time)[1:-1] == pytest.approx(result.speed[1:-1], rel=1e-4)


def test_the_mechanism_of_andrews_is_where_it_was_published_after_0_03_seconds():
    """IVP test set, release 2.4, II-14: angles of K1, K3, K5 and K7 at 0.03 s."""
    linkage, branch = andrews.start()
    motion = gk.move(linkage, np.linspace(andrews.BETA, 16.5, 4001), branch)
    result = gk.forward_dynamics(motion, andrews.LOADS, andrews.TORQUE, duration=0.03, steps=3000)
    assert result.drive[-1] == pytest.approx(15.81077119629904, abs=1e-8)
    end = {body: np.angle(result.motion.bodies[body].direction[-1]) for body in ("K3", "K5", "K7")}
    assert end["K5"] == pytest.approx(0.5244099658805304, abs=1e-8)
    assert end["K7"] == pytest.approx(1.048080741042263, abs=1e-8)
    assert end["K3"] == pytest.approx(0.04082224013073101, abs=1e-8)


def test_the_motion_ends_where_the_given_range_ends():
    part = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 1, 101))
    result = gk.forward_dynamics(part, gk.Loads(masses={"rocker": gk.Mass(1, 35)}), speed=5.0)
    assert 0 < result.time[-1] < 0.5 and result.drive.max() < 1


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"motion": gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2, 30) ** 2)}, "motion"),
        ({"loads": gk.Loads(forces=[gk.Force("crank", "A", 1j)])}, "loads.masses"),
        ({"loads": gk.Loads(masses=PENDULUM.masses, friction=[gk.PinFriction("O", 0.1, 2)])}, "loads.friction"),
        ({"torque": gk.making.motor("nema17")}, "torque"),
        ({"steps": 10**7}, "steps"),
        ({"speed": 10**30}, "speed"),
        (
            {
                "motion": gk.move(gk.FourBar(20, 30, 100, 70), TURN),
                "loads": gk.Loads(masses={"crank": gk.Mass(1.0, 9)}),
            },
            "start",
        ),
        # Steps of 0.1 s, but viscous friction stops the pendulum within a millisecond.
        (
            {
                "loads": gk.Loads(masses=PENDULUM.masses, friction=[gk.PinFriction("O", viscous=1e5)]),
                "speed": 1.0,
                "duration": 40.0,
                "steps": 400,
            },
            "steps",
        ),
    ],
)
def test_what_cannot_be_integrated_is_refused(change, field):
    with pytest.raises(gk.DesignError) as error:
        gk.forward_dynamics(**{"motion": CRANK, "loads": PENDULUM, "steps": 10} | change)
    assert error.value.field == field
