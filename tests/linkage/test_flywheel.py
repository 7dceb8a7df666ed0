"""Flywheels: a pump by an independent program, and the fluctuation that forward dynamics shows."""

import numpy as np
import pytest

import geomkin as gk


def test_a_pump_needs_the_flywheel_of_its_excess_of_energy():
    """250 N on the stroke outwards: the mean torque is 250 N x 80.22326 mm / 2 pi, the excess 11266.7 N mm."""
    motion = gk.move(gk.SliderCrank(40, 140, offset=10), np.linspace(0, 2 * np.pi, 20001), speed=20.0)
    masses = {
        "crank": gk.Mass(0.3, 8, 90),
        "coupler": gk.Mass(0.45, 52, 900),
        "slider": gk.Mass(0.6, 15, 100),
    }
    outwards = motion.point("slider_pin").velocity.real > 0
    result = gk.forces(
        motion, gk.Loads(masses=masses, forces=[gk.Force("slider", force=np.where(outwards, -250.0, 0.0))])
    )
    assert result.work / (2 * np.pi) == pytest.approx(3191.982, rel=1e-4)
    assert result.flywheel(0.02) == pytest.approx(11266.7 / (0.02 * 20**2) * 1000, rel=1e-4)


@pytest.mark.parametrize("fluctuation", [0.01, 0.05])
def test_the_speed_fluctuates_by_as_much_as_was_allowed(fluctuation):
    """Driven by the mean torque, with the flywheel, from the mean speed at the start, for more than a turn."""
    linkage, drive = gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 721)
    force = [gk.Force("rocker", "rocker_pin", gk.DriveTable([0, 2, 4, 6], [0, 50, -20, 0], 2 * np.pi))]
    result = gk.forces(gk.move(linkage, drive, speed=10.0), gk.Loads(forces=force))
    wheel = {"crank": gk.Mass(0.0, 0, result.flywheel(fluctuation))}
    mean = float(result.work) / (2 * np.pi)
    free = gk.forward_dynamics(result.motion, gk.Loads(masses=wheel, forces=force), mean, 10.0, 0.7, 1400)
    fastest, slowest = free.speed.max(), free.speed.min()
    assert (fastest**2 - slowest**2) / (2 * 10.0**2) == pytest.approx(fluctuation, rel=1e-3)


def test_a_part_of_a_turn_or_no_speed_is_refused():
    for drive, speed in ((np.linspace(0, 3, 50), 5.0), (np.linspace(0, 2 * np.pi, 50), 0.0)):
        motion = gk.move(gk.FourBar(100, 30, 90, 70), drive, speed=speed)
        with pytest.raises(gk.DesignError, match="whole turn"):
            gk.forces(motion, gk.Loads(forces=[gk.Force("rocker", "rocker_pin", -1j)])).flywheel(0.02)
