"""Where a body is wanted: poses, as an argument that is checked, and seen from the body itself."""

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

# Share of their size below which two poses are one: less is rounding of angles that were given in degrees. Larger,
# and poses that differ on purpose are refused; smaller, and rounding is taken for a displacement.
ALIKE = 1e-12
# Poses that are read, at most: a few seconds' work. More is a path, and no set of poses.
MOST_POSES = 1000


def are_poses(value: Any) -> bool:
    """Whether these are pairs (place, angle): complex mm and rad."""
    try:
        pairs = [tuple(pair) for pair in value]
    except (TypeError, ValueError):
        return False
    return all(len(pair) == 2 and is_complex(pair[0]) and _is_angle(pair[1]) for pair in pairs)


def _is_angle(value: Any) -> bool:
    # From an array of pairs, an angle comes as a complex number.
    return is_real(value) or (
        isinstance(value, complex | np.complexfloating) and value.imag == 0 and is_real(value.real)
    )


Poses = Annotated[
    Sequence[tuple[complex, float]] | Complex,
    ArgumentType(are_poses, "a row of poses, each a pair (origin x + yj in mm, angle in rad)"),
]


def placed(poses: Poses, least: int, most: int = MOST_POSES) -> tuple[Complex, Complex]:
    """Origins, mm, and directions, unit complex, (n,) each, of `least` to `most` poses that all differ.

    DesignError for fewer, for more, and for two that are alike.
    """
    count = len(poses)
    if not least <= count <= most:
        allowed = f"{least}" if least == most else f"at least {least}" if count < least else f"at most {most}"
        raise DesignError("poses", f"found {count}", f"give {allowed} of them")
    origins: Complex = np.array([complex(pair[0]) for pair in poses])
    directions: Complex = np.exp(1j * angles(poses))
    spread = np.abs(origins - origins.mean()).max()
    apart = np.abs(origins[:, None] - origins) / max(spread, np.finfo(float).tiny)
    alike = np.maximum(apart, np.abs(directions[:, None] - directions)) <= ALIKE
    if np.count_nonzero(alike) > count:
        first, second = np.nonzero(np.triu(alike, 1))
        raise DesignError(
            "poses", f"poses {first[0] + 1} and {second[0] + 1} are the same", "leave one of them out, or move it"
        )
    return origins, directions


def angles(poses: Poses) -> Real:
    """Their angles as given, rad: differences of them keep the digits that those of directions lose."""
    return np.array([complex(pair[1]).real for pair in poses])


def inverse(origins: Complex, directions: Complex) -> tuple[Complex, Complex]:
    """The same poses as the body sees them: where the ground is in the body's frame."""
    back: Complex = np.conj(directions)
    return -back * origins, back


# Half of an angle between two poses below which they count as parallel, rad: their pole is then 1e13 ways away, where
# 16 digits tell nothing of it. Larger, and true far poles are lost; smaller, and parallel poses get a pole of rounding.
PARALLEL = 1e-13


@checked
def poles(poses: Poses) -> Mapping[tuple[int, int], InstantCentre]:
    """The pole of each two poses, by their numbers from 0, (j, k) with j < k: 2 poses or more.

    It is the point about which the body could turn from one to the other, mm on the ground. Of parallel poses it is
    at infinity, square to the way between them: its `position` is nan then, and its `direction` tells where.
    Bottema and Roth, Theoretical Kinematics, 1979, chapter III.
    """
    return _poles(placed(poses, 2)[0], angles(poses))


@checked
def image_poles(poses: Poses, reference: int = 0) -> Mapping[tuple[int, int], InstantCentre]:
    """The points of the body that come to lie on the poles, where they are when it stands in pose `reference`.

    For two poses (j, k) the body's point that is at the pole of both. For the pairs that `reference` belongs to, that
    is the pole itself. Numbers from 0, as of `poles`; mm on the ground. DesignError for a pose that is not given.
    Bottema and Roth, chapter III.
    """
    origins, directions = placed(poses, 2)
    if not 0 <= reference < len(origins):
        raise DesignError("reference", f"found {reference}", f"give 0 to {len(origins) - 1}")
    on_body = _poles(inverse(origins, directions)[0], -angles(poses))
    origin, direction = origins[reference], directions[reference]
    return {
        pair: InstantCentre(origin + direction * pole.reference, direction * pole.arm, pole.weight)
        for pair, pole in on_body.items()
    }


def _poles(origins: Complex, turned: Real) -> dict[tuple[int, int], InstantCentre]:
    found = {}
    for j, k in combinations(range(len(origins)), 2):
        # On the perpendicular through the middle of the way, its half times the cotangent of half the turn.
        half = np.exp(0.5j * (turned[k] - turned[j]))
        weight = 0.0 if abs(half.imag) <= PARALLEL else float(half.imag)
        way = origins[k] - origins[j]
        arm = 0.5j * way * half.real
        # A turn about the origin itself, or by half a turn.
        found[j, k] = InstantCentre(np.asarray(0.5 * (origins[j] + origins[k])), np.asarray(arm), np.asarray(weight))
    return found


@record(eq=False)
class SliderCircle:
    """The body's points whose places at three poses lie in one line, as they stand at the first: a circle, or a line.

    curvature |s|^2 + 2 Re(conj(slope) s) + level = 0, with s from `reference`, mm, is the circle; where two of the
    poses are parallel the curvature is 0 and it is a line. Derived here; Bottema and Roth, chapter IV.
    """

    reference: complex
    curvature: float
    slope: complex
    level: float

    @property
    def centre(self) -> complex:
        """mm on the ground; nan where it is a line."""
        return self.reference - self.slope / self.curvature if self.curvature else complex(np.nan, np.nan)

    @property
    def radius(self) -> float:
        """mm; inf where it is a line."""
        if not self.curvature:
            return np.inf
        # By the factors, the root of a difference of squares keeps its digits; it is never below 0 but for rounding.
        square = abs(self.slope) ** 2 - self.curvature * self.level
        return float(np.sqrt(max(square, 0.0)) / abs(self.curvature))

    @property
    def foot(self) -> complex:
        """The point of it that is nearest to `reference`, mm."""
        reach = abs(self.slope)
        root = np.sqrt(max(reach**2 - self.curvature * self.level, 0.0))
        along = self.slope / reach if reach else 1.0
        return self.reference - along * self.level / (reach + root) if reach + root else self.reference

    @property
    def direction(self) -> complex:
        """Along the line, or of the circle at `foot`; unit complex."""
        return 1j * self.slope / abs(self.slope) if self.slope else 1j

    def curve(self, reach: float) -> AbstractCurve:
        """It as a curve: the whole circle, or of a line `reach` mm either way from `foot`."""
        if self.curvature and self.radius <= reach:
            return Circle(self.centre, self.radius)
        return Segment(self.foot - reach * self.direction, self.foot + reach * self.direction)

    def point(self, share: ArrayLike) -> Complex:
        """Points of it, mm, for shares from 0 to 1 of the whole, counterclockwise from its lowest; of a line, by
        the tangent of half a turn from `foot`, nan at its ends.
        """
        turn = np.asarray(share, dtype=float)
        if self.curvature:
            return self.centre - 1j * self.radius * np.exp(2j * np.pi * turn)
        along: Real = np.where(turn % 1 == 0, np.nan, np.tan(np.pi * (turn - 0.5)))
        return self.foot + self.direction * along


@checked
def circle_of_sliders(poses: Poses) -> SliderCircle:
    """Where, at the first of three poses, a pin of the body may sit that is to slide along a straight line.

    Its line passes through the three places of the pin; `dyads_through` with `moving` gives it. DesignError where all
    three poses are parallel: then either every point of the body slides, or none.
    """
    origins, turned = placed(poses, 3, 3)[0], angles(poses)
    # (M2 - M1) x (M3 - M1) with M the places of a point; m its place at the first pose, from there.
    half = 0.5 * (turned[1:] - turned[0])
    turns = 2j * np.sin(half) * np.exp(1j * half)
    ways = origins[1:] - origins[0]
    curvature = float(4 * np.prod(np.sin([*half, 0.5 * (turned[2] - turned[1])])))
    slope = complex(0.5 * 1j * (ways[0] * np.conj(turns[1]) - ways[1] * np.conj(turns[0])))
    level = float(cross(ways[0], ways[1]))
    if abs(turns).max() <= PARALLEL:
        raise DesignError("poses", "all three are parallel", "turn one of them: all points move alike as they are")
    if abs(curvature) <= PARALLEL * np.prod(np.abs(turns)) or np.abs(turns).min() <= PARALLEL:
        curvature = 0.0
    return SliderCircle(complex(origins[0]), curvature, slope, level)
