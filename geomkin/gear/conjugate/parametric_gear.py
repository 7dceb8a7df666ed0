"""A gear whose flank is given by formulas of a parameter."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.expressions import Expression
from ...core.fields import entry, quantity
from ...core.records import record
from ...plane.curve import AbstractCurve
from ...plane.vec import Complex, Real
from ..cutters import Settled, diametral_pitch, module, settle_module
from .shaping_gears import AbstractFlankGear

# Pieces of a flank, within which its curvature is computed, and samples that are checked.
PIECES, SAMPLES = 8, 1025
# Largest change of direction between two samples, rad; a larger one is a corner or a cusp.
CORNER = 0.1
# Name of the parameter in formulas.
PARAMETER = "t"


@record(eq=False)
class ParametricFlank(AbstractCurve):
    """The curve origin + scale (x(t) + i y(t)), open, for t from start to end."""

    x: Expression
    y: Expression
    start: float
    end: float
    origin: complex
    scale: float

    def point(self, t: ArrayLike) -> Complex:
        return np.asarray(self.origin + self.scale * (self.x(t) + 1j * self.y(t)), dtype=complex)

    def velocity(self, t: ArrayLike) -> Complex:
        return np.asarray(self.scale * (self.x.slope(t) + 1j * self.y.slope(t)), dtype=complex)

    @cached_property
    def breaks(self) -> Real:
        return np.linspace(self.start, self.end, PIECES + 1)

    closed = False


@record(checked=True)
class ParametricToothGear(AbstractFlankGear):
    """A gear about the origin whose symmetric tooth on +y has a flank given by formulas of a parameter t.

    Parameters
    ----------
    teeth : int
        Number of teeth, 4 to 1000.
    module : float
        Pitch diameter per tooth, mm, above 0. Give either `module` or `diametral_pitch`.
    x, y : str
        Formulas in t, as of `Expression`, of the points of the right-hand flank, modules: distance from the middle of
        the tooth, and height above the pitch circle, measured along the middle of the tooth.
    t_start, t_end : float, optional
        Parameter at the bottom land and at the tip; 0 and 1 if omitted.
    diametral_pitch : float, optional
        Teeth per inch of pitch diameter, 1/in.

    Raises
    ------
    DesignError
        If the formulas define no tooth, or a flank with a corner.

    Examples
    --------
    >>> gear = gk.gear.ParametricToothGear(24, 3, x="pi/4 - 0.4*t - 0.1*t**2", y="t", t_start=-1.2, t_end=1)
    >>> round(gear.tip_radius, 3), round(gear.root_radius, 3)
    (39.009, 32.574)
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=1000, example=24)
    module: Settled = module(example=3)
    x: str = entry(
        "distance of the right-hand flank from the middle of its tooth as a formula in t, modules",
        default="",
        example="pi/4 - 0.4*t - 0.1*t**2",
    )
    y: str = entry("height of that point above the pitch circle as a formula in t, modules", default="", example="t")
    t_start: float = quantity("t at the bottom land", default=0.0, at_least=-1e6, at_most=1e6, example=-1.2)
    t_end: float = quantity("t at the tip", default=1.0, at_least=-1e6, at_most=1e6, example=1)
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if not self.t_start < self.t_end:
            problem = f"found {self.t_end:g}, and the bottom land is at {self.t_start:g}"
            remedy = "give a larger number; a formula of -t reverses a curve"
            raise DesignError("t_end", problem, remedy, "out-of-range")
        self._check_smooth()
        try:
            self._check_flank()
        except DesignError as error:
            raise DesignError("x", error.problem, error.remedy, error.id) from None

    def _formula(self, name: str) -> Expression:
        text: str = getattr(self, name)
        if not text.strip():
            raise DesignError(name, "is missing", f'give a formula in t, such as {name} = "t"', "missing-key")
        try:
            return Expression(text, PARAMETER)
        except DesignError as error:
            raise DesignError(name, error.problem, error.remedy, error.id) from None

    def _check_smooth(self) -> None:
        """Raise DesignError for a formula without a value, or a corner."""
        t = np.linspace(self.t_start, self.t_end, SAMPLES)
        for name, formula in (("x", self.flank.x), ("y", self.flank.y)):
            if not (valid := np.isfinite(formula(t))).all():
                problem = f"found no finite value at t = {t[~valid][0]:.6g}"
                raise DesignError(name, problem, "give a range of t in which it has one", "not-finite")
        steps = np.diff(self.flank.point(t))
        with np.errstate(invalid="ignore", divide="ignore"):
            turn = np.abs(np.angle(steps[1:] / steps[:-1]))
        if not (turn < CORNER).all():
            place = t[1:-1][~(turn < CORNER)][0]
            problem = f"the flank has a corner, or does not move, near t = {place:.6g}"
            raise DesignError("x", problem, "give formulas of a smooth curve", "not-finite")

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, mm."""
        return self.module * self.teeth / 2

    @cached_property
    def flank(self) -> ParametricFlank:
        """Right-hand flank of the tooth on +y, from the bottom land out to the tip."""
        x, y = self._formula("x"), self._formula("y")
        return ParametricFlank(x, y, self.t_start, self.t_end, 1j * self.pitch_radius, self.module)
