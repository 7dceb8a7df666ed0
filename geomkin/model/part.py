"""Parts as a cutter or printer needs them, with limits of size and fits of ISO 286; and items to buy."""

from __future__ import annotations

import re
from bisect import bisect_left
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from ..core.arguments import ArgumentType, FloatOrNan, PositiveFloat, checked
from ..core.errors import DesignError, shown
from ..core.field_visitor import WrittenForm
from ..core.fields import Length, still_picture, to_digits
from ..core.names import check_names
from ..core.records import record
from ..core.units import as_sentences, mm
from ..plane.curve import AbstractCurve
from ..plane.measure import AreaMoments, area_moments
from ..plane.vec import Pose, dot
from .material import Mass, Material

# Upper ends of the ranges of nominal sizes, mm, and standard tolerances, micrometres, by grade.
# Source: ISO 286-1:2010, table 1. With other numbers a part does not fit its standard mate.
RANGES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
GRADES: dict[int, tuple[float, ...]] = {
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400),
}
# Least distances of the tolerance zones of shafts from the nominal size, micrometres: below it for d to h, above it for
# k to s. Source: ISO 286-1:2010, tables 4 and 5. That of k is of the grades to 7; in others it is 0.
SHAFTS: dict[str, tuple[float, ...]] = {
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20),
    "h": (0,) * 13,
    "js": (0,) * 13,
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
}
# The same for r and s, whose ranges are narrower above 50 mm.
NARROW = (3, 6, 10, 18, 30, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500)
NARROW_SHAFTS: dict[str, tuple[float, ...]] = {
    "r": (10, 15, 19, 23, 28, 34, 41, 43, 51, 54, 63, 65, 68, 77, 80, 84, 94, 98, 108, 114, 126, 132),
    "s": (14, 19, 23, 28, 35, 43, 53, 59, 71, 79, 92, 100, 108, 122, 130, 140, 158, 170, 190, 208, 232, 252),
}
LETTERS = (*SHAFTS, *NARROW_SHAFTS)
TOLERANCE = re.compile(rf"({'|'.join(LETTERS)})({'|'.join(map(str, GRADES))})", re.IGNORECASE)
ALLOWED = f"letters {', '.join(LETTERS)}, capital for holes, with grades {min(GRADES)} to {max(GRADES)}"


def _parsed(tolerance: str, is_hole: bool) -> tuple[str, int] | None:
    """Letter, in lower case, and grade of a tolerance class; None if there is no such class of a hole or a shaft."""
    match = TOLERANCE.fullmatch(tolerance)
    if match is None or not (match[1].isupper() if is_hole else match[1].islower()):
        return None
    return match[1].lower(), int(match[2])


def limits(tolerance: str, nominal: float) -> tuple[float, float]:
    """Lower and upper deviation of a tolerance class from the nominal size, mm.

    Parameters
    ----------
    tolerance : str
        Class such as "H7" of a hole or "g6" of a shaft.
    nominal : float
        Nominal diameter, mm, above 0 and at most 500.

    Raises
    ------
    DesignError
        If there is no such class, or the standard has none of this size.
    """
    is_hole = tolerance[:1].isupper()
    if (parsed := _parsed(tolerance, is_hole)) is None:
        raise DesignError("fit", f"found {shown(tolerance)}", f"give {ALLOWED}", "out-of-range")
    if not 0 < nominal <= RANGES[-1]:
        problem = f"found {tolerance} for a diameter of {mm(nominal):g}"
        remedy = f"give a diameter above 0 and at most {mm(RANGES[-1]):g}, or a clearance in place of a fit"
        raise DesignError("fit", problem, remedy, "out-of-range")
    letter, grade = parsed
    row = bisect_left(RANGES, nominal)
    width = GRADES[grade][row]
    if letter == "js":
        low, high = -width / 2, width / 2
    elif is_hole:
        low, high = _hole(letter, grade, nominal, width)
    elif letter <= "h":
        low, high = -_distance(letter, nominal) - width, -_distance(letter, nominal)
    else:
        least = 0.0 if letter == "k" and grade > 7 else _distance(letter, nominal)
        low, high = least, least + width
    return to_digits(low / 1000, 9), to_digits(high / 1000, 9)


def _distance(letter: str, nominal: float) -> float:
    if letter in NARROW_SHAFTS:
        return NARROW_SHAFTS[letter][bisect_left(NARROW, nominal)]
    return SHAFTS[letter][bisect_left(RANGES, nominal)]


def _hole(letter: str, grade: int, nominal: float, width: float) -> tuple[float, float]:
    """Deviations of a hole: those of the shaft of its letter mirrored, by the rules of ISO 286-1, 4.3.2.5."""
    distance, row = _distance(letter, nominal), bisect_left(RANGES, nominal)
    if letter <= "h":
        return distance, distance + width
    # In fine grades a hole with the shaft of the next finer grade fits as tightly as with its own letter reversed.
    is_fine = 3 < nominal and grade <= (8 if letter in "kmn" else 7) and grade > min(GRADES)
    upper = -distance + (width - GRADES[grade - 1][row] if is_fine else 0.0)
    if grade > 8 and (letter == "k" or (letter == "n" and nominal > 3)):
        upper = 0.0
    if (letter, grade) == ("m", 6) and 250 < nominal <= 315:
        upper = -9.0
    return upper - width, upper


@record
class FitLimits:
    """Deviations of a hole and of its shaft from their nominal size, mm.

    Parameters
    ----------
    hole, shaft : tuple of float
        Lower and upper deviation, mm; those of the shaft are 0 if its tolerance is not given.
    """

    hole: tuple[float, float]
    shaft: tuple[float, float]

    @property
    def least_clearance(self) -> float:
        """Smallest difference of the diameters of hole and shaft, mm; negative for an interference."""
        return to_digits(self.hole[0] - self.shaft[1])

    @property
    def largest_clearance(self) -> float:
        """Largest difference of the diameters of hole and shaft, mm."""
        return to_digits(self.hole[1] - self.shaft[0])

    @property
    def middle(self) -> float:
        """Middle of the deviations of the hole, mm, at which it is drawn to be cut."""
        return to_digits((self.hole[0] + self.hole[1]) / 2)

    @property
    def is_press(self) -> bool:
        """Whether the shaft is on average wider than the hole."""
        return sum(self.hole) < sum(self.shaft)


def fit_limits(fit: str, nominal: float) -> FitLimits:
    """Limits of a fit of ISO 286.

    Parameters
    ----------
    fit : str
        Tolerance class of the hole, such as "H7", or of hole and shaft, such as "H7/g6".
    nominal : float
        Nominal diameter, mm, above 0 and at most 500.

    Returns
    -------
    FitLimits

    Raises
    ------
    DesignError
        If there is no such class, or the standard has none of this size.

    Examples
    --------
    >>> from geomkin.model.part import fit_limits
    >>> fit_limits("H7/g6", 25).largest_clearance
    0.041
    """
    hole, _, shaft = fit.partition("/")
    return FitLimits(limits(hole, nominal), limits(shaft, nominal) if shaft else (0.0, 0.0))


class FitClass(ArgumentType, WrittenForm):
    """Marks a text that is a fit of ISO 286, the tolerance class of a hole, or one of some other words."""

    def __init__(self, words: tuple[str, ...], has_shaft: bool, allows_hole: bool) -> None:
        example = '"H7/g6"' if has_shaft else '"H7"'
        kind = "a fit" if has_shaft else "a tolerance class"
        named = f"{' or '.join(words)}, or " if any(words) else ""
        alone = "" if allows_hole else " (of a hole alone: bore_tolerance)"

        def fits(value: Any) -> bool:
            if not isinstance(value, str) or value in words:
                return isinstance(value, str)
            hole, slash, shaft = value.partition("/")
            has_hole = _parsed(hole, True) is not None
            return has_hole and ((has_shaft and _parsed(shaft, False) is not None) or (allows_hole and not slash))

        super().__init__(fits, f"{named}{kind} of ISO 286 such as {example}{alone}: {ALLOWED}", (str,))


# A fit of a bore: running or press by the clearance or interference of its stock, or a fit of ISO 286.
Fit = Annotated[str, FitClass(("running", "press"), True, False)]
# A fit of ISO 286, or the tolerance class of a hole; "" for none.
IsoFit = Annotated[str, FitClass(("",), True, True)]
HoleTolerance = Annotated[str, FitClass(("",), False, True)]


@record(checked=True)
class Twist:
    """Motion of a solid's section from its bottom, which the drawing shows, to its top, in proportion to the height.

    Parameters
    ----------
    turn : float, optional
        Rotation about the part's origin, rad, counterclockwise as seen from above.
    shift : float, optional
        Displacement along x, mm.
    herringbone : bool, optional
        Whether the motion is complete at half the height and reverses to the top.
    moves : {"outline", "holes"}, optional
        The curves that move; the others are straight.

    See Also
    --------
    Part
    """

    turn: float = 0.0
    shift: float = 0.0
    herringbone: bool = False
    moves: Literal["outline", "holes"] = "outline"

    @checked
    def at(self, share: FloatOrNan) -> Pose:
        """Pose of the moving curves at given heights.

        Parameters
        ----------
        share : float or array_like
            Shares of the height, 0 at the bottom and 1 at the top, any shape.

        Returns
        -------
        Pose
            Of the same shape, mm.
        """
        progress = np.asarray(share, dtype=float)
        progress = 1 - abs(2 * progress - 1) if self.herringbone else progress
        return Pose(self.shift * progress + 0j, np.exp(1j * self.turn * progress))


@record(checked=True)
class HoleFit:
    """The fit of a hole on its shaft, pin or screw; all in mm.

    Parameters
    ----------
    diameter : float
        Diameter of the shaft, pin or screw, mm, above 0.
    play : float
        How much wider the hole is drawn, mm; negative for a press fit, unless holes come out narrower than drawn.
    flat : float, optional
        Of a hole for a D-shaft, from its flat side across to the round side, mm; 0 for none.
    flats : {1, 2, 4, 6}, optional
        Number of flats; of several, `flat` is the distance of opposite ones.
    keyway : tuple of float, optional
        Width of the keyway, and its depth beyond the bore along the centre line, mm; 0 for none.
    travel : float, optional
        Of a slot, the distance of the centres of its ends, mm; 0 for a hole.
    is_press : bool, optional
        Whether it is a press fit, as every one with a negative play.
    iso_fit : str, optional
        Tolerance class of the hole by ISO 286, such as "H7", or with that of its shaft, as "H7/g6"; "" for none.

    See Also
    --------
    Part
    """

    diameter: PositiveFloat
    play: float
    flat: Length = 0.0
    keyway: tuple[Length, Length] = (0.0, 0.0)
    travel: Length = 0.0
    flats: Literal[1, 2, 4, 6] = 1
    is_press: bool = False
    iso_fit: IsoFit = ""

    @property
    def limits(self) -> FitLimits | None:
        """Limits of the hole and its shaft by ISO 286; None without such a fit."""
        return fit_limits(self.iso_fit, self.diameter) if self.iso_fit else None


@record(checked=True, eq=False)
class Part:
    """A plate, or a solid with a moving section such as a helical gear.

    Parameters
    ----------
    name : str
        Name of the part and of its file.
    outline : AbstractCurve
        Closed curve in the part's frame, mm, in either direction.
    holes : tuple of AbstractCurve
        Closed curves, mm.
    thickness : float
        Thickness of the sheet, mm.
    layer : str, optional
        Layer of the outline, the operation that cuts it.
    count : int, optional
        Number of copies to make.
    marks : tuple of AbstractCurve, optional
        Open or closed curves that are engraved inside the outline, mm.
    body : str, optional
        Name of the mechanism's body whose motion the part follows; "" for a part without motion.
    hole_names : tuple of str, optional
        Text engraved next to each hole, such as the letter of a joint.
    twist : Twist, optional
        Motion of the section along the height; None for straight sides.
    fits : tuple of HoleFit or None, optional
        Fits of the holes in their order, None for an empty hole; may be shorter than `holes`.
    material : Material, optional
        Material of the sheet or print; None if unknown.
    joints : tuple of str, optional
        Letters of the joints that the copies of a printed pin make.

    Raises
    ------
    DesignError
        If the name cannot be a file name, or there are more fits than holes.

    See Also
    --------
    Material, Twist, write

    Examples
    --------
    >>> square = gk.plane.Polyline(np.array([0, 40, 40 + 40j, 40j]))
    >>> gk.Part("plate", square, (), thickness=3.0).layer
    'CUT'
    """

    name: str
    outline: AbstractCurve
    holes: tuple[AbstractCurve, ...]
    thickness: float
    layer: str = "CUT"
    count: int = 1
    marks: tuple[AbstractCurve, ...] = ()
    body: str = ""
    hole_names: tuple[str, ...] = ()
    twist: Twist | None = None
    fits: tuple[HoleFit | None, ...] = ()
    material: Material | None = None
    joints: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_names("name", [self.name], "a part")
        if len(self.fits) > len(self.holes):
            problem = f"found {len(self.fits)} for {len(self.holes)} holes"
            raise DesignError("fits", problem, "give one for each hole", "conflict")

    def _repr_svg_(self) -> str | None:
        return still_picture(self, (self.outline, *self.holes), self.marks)

    @cached_property
    def mass(self) -> Mass | None:
        """Mass, centre and inertia of one copy in the part's frame; None without a material.

        From the exact outline and holes; of a twisted solid, the mean of its sections. DesignError if it is too large.
        """
        if self.material is None:
            return None
        moves_outline = self.twist is not None and self.twist.moves == "outline"
        section = _mean(area_moments(self.outline), self.twist if moves_outline else None)
        for hole in self.holes:
            section += -_mean(area_moments(hole), None if moves_outline else self.twist)
        centre = section.centroid
        # kg per mm2 of the section.
        areal_density = self.material.density * 1e-9 * self.thickness
        inertia = section.polar - section.area * abs(centre) ** 2
        mass, inertia = areal_density * section.area, areal_density * inertia
        try:
            return Mass(mass, centre, inertia)
        except DesignError as error:
            problem = (
                f"the {self.name} has a mass of {mass:.3g} kg and an inertia of {inertia:.3g} kg mm2, out of range"
            )
            raise DesignError(
                self.name, problem, "give smaller lengths, or a smaller scale if one is given", error.id
            ) from None


# Shares of the height and their weights: Gauss' rule on each half, since a herringbone turns back in the middle. These
# points suffice for a twist of up to a hundred revolutions.
_GAUSS = np.polynomial.legendre.leggauss(64)
_HEIGHTS = np.concatenate([0.25 + 0.25 * _GAUSS[0], 0.75 + 0.25 * _GAUSS[0]])
_SHARES = np.concatenate([_GAUSS[1], _GAUSS[1]]) / 4


def _mean(moments: AreaMoments, twist: Twist | None) -> AreaMoments:
    """Moments of a section that a twist moves, as means over the height."""
    if twist is None:
        return moments
    pose = twist.at(_HEIGHTS)
    first = pose.direction * moments.first
    polar = moments.polar + 2 * dot(pose.origin, first) + np.abs(pose.origin) ** 2 * moments.area
    return AreaMoments(moments.area, complex(_SHARES @ (first + pose.origin * moments.area)), float(_SHARES @ polar))


@record
class Bought:
    """A line of the bill of materials: an item to buy, or to cut from a rod.

    Parameters
    ----------
    name : str
        The item.
    count : int
        Number of pieces.
    joints : tuple of str
        Its joints, by the letters at their holes or by the names of the parts that turn on it.
    """

    name: str
    count: int
    joints: tuple[str, ...]

    def __post_init__(self) -> None:
        as_sentences(self, "name")

    @property
    def data(self) -> dict[str, object]:
        """The item as plain values, for files."""
        return {"name": self.name, "count": self.count, "joints": list(self.joints)}
