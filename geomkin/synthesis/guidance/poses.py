"""Poses of a body as a checked argument, their poles, and the circle of sliders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import ArgumentType, checked, is_complex, is_real
from ...core.errors import DesignError
from ...core.records import record
from ...linkage.instant.centres import InstantCentre
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, Segment
from ...plane.vec import Complex, Real, cross

# Relative difference below which two poses are equal. It covers the rounding of angles given in degrees; a larger value
# refuses poses that differ on purpose, a smaller one takes rounding for a displacement.
ALIKE = 1e-12
# Largest number of poses, a few seconds of computation.
MOST_POSES = 1000


def are_poses(value: Any) -> bool:
    """Whether a value is a sequence of pairs (complex position in mm, angle in rad)."""
    try:
        pairs = [tuple(pair) for pair in value]
    except (TypeError, ValueError):
        return False
    return all(len(pair) == 2 and is_complex(pair[0]) and _is_angle(pair[1]) for pair in pairs)


def _is_angle(value: Any) -> bool:
    # In an array of pairs an angle is a complex number.
    return is_real(value) or (
        isinstance(value, complex | np.complexfloating) and value.imag == 0 and is_real(value.real)
    )


Poses = Annotated[
    Sequence[tuple[complex, float]] | Complex,
    ArgumentType(are_poses, "a row of poses, each a pair (origin x + yj in mm, angle in rad)"),
]


def distinct_poses(poses: Poses, least: int, most: int = MOST_POSES) -> tuple[Complex, Complex]:
    """Origins, mm, and directions, unit complex, (n,) each, of `least` to `most` distinct poses; else DesignError."""
    count = len(poses)
    if not least <= count <= most:
        allowed = f"{least}" if least == most else f"at least {least}" if count < least else f"at most {most}"
        raise DesignError("poses", f"found {count}", f"give {allowed} of them", "out-of-range")
    origins: Complex = np.array([complex(pair[0]) for pair in poses])
    directions: Complex = np.exp(1j * angles(poses))
    spread = np.abs(origins - origins.mean()).max()
    distances = np.abs(origins[:, None] - origins) / max(spread, np.finfo(float).tiny)
    is_equal = np.maximum(distances, np.abs(directions[:, None] - directions)) <= ALIKE
    if np.count_nonzero(is_equal) > count:
        first, second = np.nonzero(np.triu(is_equal, 1))
        problem = f"poses {first[0] + 1} and {second[0] + 1} are the same"
        raise DesignError("poses", problem, "leave one of them out, or move it", "conflict")
    return origins, directions


def angles(poses: Poses) -> Real:
    """The angles as given, rad; differences of them keep digits that differences of directions lose."""
    return np.array([complex(pair[1]).real for pair in poses])


def inverse(origins: Complex, directions: Complex) -> tuple[Complex, Complex]:
    """The poses of the ground in the body's frame."""
    back: Complex = np.conj(directions)
    return -back * origins, back


# Half of an angle between two poses, rad, below which they are parallel: their pole is then 1e13 displacements away,
# beyond the precision of numbers. A larger value loses true far poles; a smaller one gives parallel poses a pole made
# of rounding.
PARALLEL = 1e-13


@checked
def poles(poses: Poses) -> Mapping[tuple[int, int], InstantCentre]:
    """Find the pole of each pair of poses.

    The pole is the point about which the body could rotate from one pose to the other.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Two or more poses, each an origin x + yj in mm and an angle in rad.

    Returns
    -------
    mapping of (int, int) to InstantCentre
        The pole of poses j and k, j < k, numbered from 0, mm on the ground. For parallel poses it is at infinity: its
        `position` is nan, and its `direction` is at right angles to the displacement.

    Raises
    ------
    DesignError
        For fewer than two poses, or equal ones.

    Notes
    -----
    Bottema and Roth, Theoretical Kinematics, 1979, chapter III.

    Examples
    --------
    >>> from geomkin.synthesis import poles
    >>> pole = complex(poles([(0j, 0.0), (2 + 2j, 3.141592653589793 / 2)])[0, 1].position)

    """
    return _poles(distinct_poses(poses, 2)[0], angles(poses))


@checked
def image_poles(poses: Poses, reference: int = 0) -> Mapping[tuple[int, int], InstantCentre]:
    """Find the body's points that coincide with the poles, positioned as in pose `reference`.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Two or more poses, each an origin x + yj in mm and an angle in rad.
    reference : int
        Number, from 0, of the pose in which the body is shown.

    Returns
    -------
    mapping of (int, int) to InstantCentre
        For poses j and k the point of the body that is at their pole in both, mm on the ground. For pairs that contain
        `reference` it is the pole itself.

    Raises
    ------
    DesignError
        If `reference` is not a pose.

    Notes
    -----
    Bottema and Roth, Theoretical Kinematics, 1979, chapter III.
    """
    origins, directions = distinct_poses(poses, 2)
    if not 0 <= reference < len(origins):
        raise DesignError("reference", f"found {reference}", f"give 0 to {len(origins) - 1}", "out-of-range")
    on_body = _poles(inverse(origins, directions)[0], -angles(poses))
    origin, direction = origins[reference], directions[reference]
    return {
        pair: InstantCentre(origin + direction * pole.reference, direction * pole.arm, pole.weight)
        for pair, pole in on_body.items()
    }


def _poles(origins: Complex, angles: Real) -> dict[tuple[int, int], InstantCentre]:
    poles_by_pair = {}
    for j, k in combinations(range(len(origins)), 2):
        # The pole is on the perpendicular bisector of the displacement, at half of it times the cotangent of half the
        # rotation.
        half = np.exp(0.5j * (angles[k] - angles[j]))
        weight = 0.0 if abs(half.imag) <= PARALLEL else float(half.imag)
        displacement = origins[k] - origins[j]
        arm = 0.5j * displacement * half.real
        poles_by_pair[j, k] = InstantCentre(
            np.asarray(0.5 * (origins[j] + origins[k])), np.asarray(arm), np.asarray(weight)
        )
    return poles_by_pair


@record(eq=False)
class SliderCircle:
    """Points of a body whose positions at three poses are collinear, shown at the first pose: a circle or a line.

    The circle is curvature |s|^2 + 2 Re(conj(slope) s) + level = 0, with s measured from `reference`.

    Parameters
    ----------
    reference : complex
        Origin of s, mm.
    curvature, slope, level : float, complex, float
        Coefficients; the curvature is 0, and the circle a line, if two of the poses are parallel.

    Notes
    -----
    Derived here; compare Bottema and Roth, Theoretical Kinematics, 1979, chapter IV.
    """

    reference: complex
    curvature: float
    slope: complex
    level: float

    @property
    def centre(self) -> complex:
        """Centre, mm on the ground; nan for a line."""
        return self.reference - self.slope / self.curvature if self.curvature else complex(np.nan, np.nan)

    @property
    def radius(self) -> float:
        """Radius, mm; inf for a line."""
        if not self.curvature:
            return np.inf
        # Never negative except for rounding.
        square = abs(self.slope) ** 2 - self.curvature * self.level
        return float(np.sqrt(max(square, 0.0)) / abs(self.curvature))

    @property
    def foot(self) -> complex:
        """The point of the circle that is nearest to `reference`, mm."""
        slope_size = abs(self.slope)
        root = np.sqrt(max(slope_size**2 - self.curvature * self.level, 0.0))
        along = self.slope / slope_size if slope_size else 1.0
        return self.reference - along * self.level / (slope_size + root) if slope_size + root else self.reference

    @property
    def direction(self) -> complex:
        """Direction of the line, or of the circle at `foot`; unit complex."""
        return 1j * self.slope / abs(self.slope) if self.slope else 1j

    def curve(self, reach: float) -> AbstractCurve:
        """The whole circle as a curve, or a piece of the line.

        Parameters
        ----------
        reach : float
            Half the length of the piece about `foot`, mm; a circle with a larger radius is drawn as a line too.
        """
        if self.curvature and self.radius <= reach:
            return Circle(self.centre, self.radius)
        return Segment(self.foot - reach * self.direction, self.foot + reach * self.direction)

    def point(self, share: ArrayLike) -> Complex:
        """Points of the circle or line.

        Parameters
        ----------
        share : array_like
            Position from 0 to 1: on a circle counterclockwise from its lowest point, on a line by the tangent of half a
            turn from `foot`.

        Returns
        -------
        array of complex
            Points, mm; nan at the ends of a line.
        """
        turn = np.asarray(share, dtype=float)
        if self.curvature:
            return self.centre - 1j * self.radius * np.exp(2j * np.pi * turn)
        along: Real = np.where(turn % 1 == 0, np.nan, np.tan(np.pi * (turn - 0.5)))
        return self.foot + self.direction * along


@checked
def circle_of_sliders(poses: Poses) -> SliderCircle:
    """Find the possible positions of a pin that slides along a straight line at three poses.

    The line of a pin passes through its three positions; `dyads_through` with `moving` gives it.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Three poses, each an origin x + yj in mm and an angle in rad.

    Returns
    -------
    SliderCircle
        The pins at the first pose.

    Raises
    ------
    DesignError
        If all three poses are parallel: then either every point of the body slides, or none.
    """
    origins, given_angles = distinct_poses(poses, 3, 3)[0], angles(poses)
    # (M2 - M1) x (M3 - M1), with M1, M2, M3 the positions of a point, written in its position at the first pose.
    half = 0.5 * (given_angles[1:] - given_angles[0])
    rotations = 2j * np.sin(half) * np.exp(1j * half)
    displacements = origins[1:] - origins[0]
    curvature = float(4 * np.prod(np.sin([*half, 0.5 * (given_angles[2] - given_angles[1])])))
    slope = complex(0.5 * 1j * (displacements[0] * np.conj(rotations[1]) - displacements[1] * np.conj(rotations[0])))
    level = float(cross(displacements[0], displacements[1]))
    if abs(rotations).max() <= PARALLEL:
        raise DesignError(
            "poses", "all three are parallel", "rotate one of them, since otherwise all points move alike"
        )
    if abs(curvature) <= PARALLEL * np.prod(np.abs(rotations)) or np.abs(rotations).min() <= PARALLEL:
        curvature = 0.0
    return SliderCircle(complex(origins[0]), curvature, slope, level)
