"""Parts of a mechanism, as a cutter or printer needs them, and items to buy."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np

from ..core.arguments import FloatOrNan, PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import Length, still_picture
from ..core.names import check_names
from ..core.records import record
from ..core.units import as_sentences
from ..plane.curve import AbstractCurve
from ..plane.measure import AreaMoments, area_moments
from ..plane.vec import Pose, dot
from .limits import FitLimits, IsoFit, fit_limits
from .material import Mass, Material


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
            raise DesignError(
                "fits", f"found {len(self.fits)} for {len(self.holes)} holes", "give one for each hole", "conflict"
            )

    def _repr_svg_(self) -> str | None:
        return still_picture(self, (self.outline, *self.holes), self.marks)

    @cached_property
    def mass(self) -> Mass | None:
        """Mass, centre and inertia of one copy in the part's frame; None without a material.

        From the exact outline and holes; of a twisted solid, the mean of its sections.
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
        return Mass(areal_density * section.area, centre, areal_density * inertia)


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
