"""Where a body is wanted: poses, as an argument that is checked, and seen from the body itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np

from ...arguments import Sort, is_complex, is_real
from ...errors import DesignError
from ...plane.vec import Complex, Real

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
    Sort(are_poses, "a row of poses, each a pair (origin x + yj in mm, angle in rad)"),
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
