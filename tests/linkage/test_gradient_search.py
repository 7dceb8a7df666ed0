"""A gradient optimiser on the library's derivatives against one without gradients, and against the closed form."""

import nlopt
import numpy as np
import pytest

import geomkin as gk

GROUND, SWING, TURN = 100.0, np.radians(50), np.radians(200)
SIZES = "crank", "coupler", "rocker"
STARTS = (35.0, 100.0, 80.0), (30.0, 100.0, 80.0), (35.0, 110.0, 80.0), (35.0, 90.0, 70.0)


class Search:
    """Crank, coupler and rocker with the largest least transmission angle for a swing and the crank's turn meanwhile.

    The fourth unknown is the least transmission angle, rad: it lies at a crank angle of 0 or pi.
    """

    def __init__(self, algorithm, uses_gradient, start):
        self.uses_gradient, self.points, self.last = uses_gradient, [], None
        optimiser = nlopt.opt(algorithm, 4)
        optimiser.set_max_objective(self.objective)
        optimiser.add_inequality_mconstraint(self.above_transmission, [1e-9] * 2)
        optimiser.add_equality_mconstraint(self.off_task, [1e-9] * 2)
        optimiser.set_lower_bounds([10, 40, 20, 0.1])
        optimiser.set_upper_bounds([60, 180, 150, 1.5])
        optimiser.set_xtol_rel(1e-10)
        optimiser.set_maxeval(2000)
        optimiser.optimize([*start, 0.5])

    def calls_until(self, wanted):
        """Number of motions until the sizes stay within a millionth of a millimetre."""
        far = [k for k, point in enumerate(self.points) if np.abs(point - wanted).max() > 1e-6]
        return far[-1] + 2

    def motion_at(self, sizes):
        """Both transmission angles, swing and turn, and their derivatives by the sizes, from one motion."""
        if self.last is None or not np.array_equal(self.points[-1], sizes):
            self.points.append(sizes.copy())
            a, b, c = sizes.tolist()
            stretched, folded = (np.arccos((GROUND**2 + s * s - c * c) / (2 * GROUND * s)) for s in (b + a, b - a))
            drive = np.array([0.0, np.pi, stretched, folded + np.pi])
            motion = gk.move(gk.FourBar(GROUND, a, b, c), drive)
            rocker = np.angle(motion.rocker.direction)
            values = np.array([*motion.transmission_angle[:2], rocker[3] - rocker[2], drive[3] - drive[2]])
            slopes = np.empty((4, 3))
            for k, size in enumerate(SIZES if self.uses_gradient else ()):
                slopes[:2, k] = motion.sensitivity("transmission_angle", by=size)[:2]
                # At the ends of its swing the rocker's angle does not depend on the crank; their crank angles follow by
                # implicit differentiation of a rocker that stands still.
                ends = motion.sensitivity("rocker_angle", by=size)
                cranks = -motion.sensitivity("rocker_omega", by=size) / motion.rocker.second
                slopes[2:, k] = ends[3] - ends[2], cranks[3] - cranks[2]
            self.last = values, slopes
        return self.last

    def objective(self, x, gradient):
        if gradient.size:
            gradient[:] = 0, 0, 0, 1
        return x[3]

    def above_transmission(self, result, x, gradient):
        values, slopes = self.motion_at(x[:3])
        result[:] = x[3] - values[:2]
        if gradient.size:
            gradient[:, :3], gradient[:, 3] = -slopes[:2], 1

    def off_task(self, result, x, gradient):
        values, slopes = self.motion_at(x[:3])
        result[:] = values[2:] - (SWING, TURN)
        if gradient.size:
            gradient[:, :3], gradient[:, 3] = slopes[2:], 0


@pytest.mark.campaign
def test_gradients_find_the_best_crank_rocker_in_a_tenth_of_the_calls():
    best = gk.crank_rocker(np.degrees(SWING), np.degrees(TURN), ground=GROUND).linkage
    sizes = np.array([best.crank, best.coupler, best.rocker])
    with_gradient = sum(Search(nlopt.LD_SLSQP, True, start).calls_until(sizes) for start in STARTS)
    without = sum(Search(nlopt.LN_COBYLA, False, start).calls_until(sizes) for start in STARTS)
    print(f"{with_gradient} motions with gradients, {without} without")
    assert 10 * with_gradient <= without
