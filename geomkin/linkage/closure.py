"""Where the loop of a four-bar closes, in the form that keeps its digits at a toggle.

The textbook forms go through the diagonal's square a^2 + d^2 - 2 a d cos t and lose half the digits of
position, and all of those of velocity, as the linkage nears a toggle. Here every quantity that
vanishes at a toggle is a product of factors, and the constants among them are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..plane.vec import Array


@dataclass(frozen=True, eq=False)
class Closure:
    """One row of frames. Directions are unit complex; kinematic coefficients are per rad of crank.

    coupler, rocker: directions; coupler_first, rocker_first: d(angle)/d(crank angle); *_second: the
    same once more. nan where the loop does not close; the coefficients are not finite at a toggle.
    """

    coupler: Array
    rocker: Array
    coupler_first: Array
    rocker_first: Array
    coupler_second: Array
    rocker_second: Array


def close_four_bar(ground: float, crank: float, coupler: float, rocker: float, angle: Array, branch: int) -> Closure:
    """Solve the loop a e^{it} + b e3 = d + c e4 for the crank angles t, rad, on one branch.

    a crank, b coupler, c rocker, d ground. branch +1: the coupler-rocker pin lies left of the line from
    crank pin to rocker pivot. With u that line, s = |u|^2 and r = branch sqrt(F1 F2), where F1 and F2
    are zero at the stretched and the folded toggle:

        b e3 = (p + i q) u,  p = (s + b^2 - c^2) / 2s,  q = r / 2s

    h3 = psi' - p1 tau and h4 = psi' + p tau follow, psi' being the turn of u and tau = 2 a d sin t / r.
    """
    a, b, c, d = (float(v) for v in (crank, coupler, rocker, ground))
    ea, eb, ec, ed = (Fraction(v) for v in (a, b, c, d))
    stretched = float((eb + ec) ** 2 - (ea + ed) ** 2)
    folded = float((ed - ea) ** 2 - (eb - ec) ** 2)
    b2_less_c2 = float(eb**2 - ec**2)
    nearest = float((ed - ea) ** 2)

    x = 4 * a * d * np.cos(angle / 2) ** 2
    y = 4 * a * d * np.sin(angle / 2) ** 2
    f1, f2 = stretched + x, folded + y
    s = nearest + y
    u = d - a * np.exp(1j * angle)
    with np.errstate(invalid="ignore", divide="ignore"):
        r = branch * np.sqrt(f1 * np.where(f1 >= 0, f2, np.nan))
        p, p1, q = (s + b2_less_c2) / (2 * s), (s - b2_less_c2) / (2 * s), r / (2 * s)
        coupler_vector = (p + 1j * q) * u
        sine = a * d * np.sin(angle)
        tau = 2 * sine / r
        psi = (a * a - a * d * np.cos(angle)) / s
        tau_rate = (folded * x * f1 - stretched * y * f2) / (2 * r**3)
        shared = (sine / s) * (1 - 2 * psi + (p1 - p) * tau)
        return Closure(
            coupler=coupler_vector / b,
            rocker=(coupler_vector - u) / c,
            coupler_first=psi - p1 * tau,
            rocker_first=psi + p * tau,
            coupler_second=shared - p1 * tau_rate,
            rocker_second=shared + p * tau_rate,
        )
