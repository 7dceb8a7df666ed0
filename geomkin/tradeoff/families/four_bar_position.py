"""Position of a four-bar, of an ordinary one and of one that comes near a toggle."""

from __future__ import annotations

import numpy as np

from ...linkage.bars import FourBar
from ...plane.vec import Real
from ..family import MethodFamily
from .four_bar_approximations import ITERATIONS, TABLES
from .four_bar_closed_forms import CLOSED_FORMS
from .four_bar_problem import FRAMES, NEAR_TOGGLE, ORDINARY, Directions, FourBarProblem


def _error(problem: FourBarProblem, found: Directions) -> Real:
    one, two = (np.abs(z - right) for z, right in zip(found, problem.directions))
    return np.maximum(one, two)


def _family(name: str, title: str, about: str, linkage: FourBar) -> MethodFamily[FourBarProblem, Directions]:
    return MethodFamily(
        name=name,
        title=title,
        about=f"{about} Found are the directions of coupler and rocker at {FRAMES} even steps of a whole turn of the "
        "crank; the error is that of the worse of the two.",
        per="pose",
        unit="rad",
        reference="circles that meet, in decimal arithmetic of 110 digits",
        floor=1e-15,
        problem=lambda: FourBarProblem.of(linkage),
        count=lambda _, found: len(found[0]),
        error=_error,
        methods=(*CLOSED_FORMS, *ITERATIONS, *TABLES),
    )


POSITION = _family(
    "four-bar-position",
    "Position of a four-bar",
    "A crank-rocker of 30, 90, 70 and 100 mm, which stays away from its toggles.",
    ORDINARY,
)
TOGGLE = _family(
    "four-bar-toggle",
    "Position of a four-bar near its toggle",
    "A four-bar of 30, 60, 70 and 100 mm, whose rocker is longer than that by a hundred-millionth of a mm: once a turn "
    "all its links lie nearly on one line.",
    NEAR_TOGGLE,
)
