"""What a mechanism is made of: parts, as a cutter or a printer needs to know them, and things that are bought."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ..core.arguments import Positive, RealsOrNan, checked
from ..core.errors import DesignError
from ..core.fields import Length
from ..core.names import check_names
from ..core.records import record
from ..core.reprs import still
from ..plane.curve import AbstractCurve
from ..plane.vec import Pose


@record(checked=True)
class Twist:
    """How the section of a solid moves from its bottom, which the drawing shows, to its top.

    It turns about the part's origin by `turn`, rad, counterclockwise as seen from above, and slides along x by `shift`,
    mm, in proportion to the height. herringbone: all the way at half the height, and back again at the top. moves: what
    of the section; the rest goes straight up.
    """

    turn: float = 0.0
    shift: float = 0.0
    herringbone: bool = False
    moves: Literal["outline", "holes"] = "outline"

    @checked
    def at(self, share: RealsOrNan) -> Pose:
        """Where what moves stands at shares of the height, 0 at the bottom and 1 at the top, any shape."""
        way = np.asarray(share, dtype=float)
        way = 1 - abs(2 * way - 1) if self.herringbone else way
        return Pose(self.shift * way + 0j, np.exp(1j * self.turn * way))


@record(checked=True)
class HoleFit:
    """What goes through a hole, and how it sits there; all in mm.

    diameter: of the round thing that goes through. play: how much wider the hole is, negative where it is pressed on.
    flat: of the hole for a D-shaft, from its flat side across to the round one; 0 for none. keyway: its width, and its
    depth beyond the bore, along its middle; 0 for none. travel: of what slides in a slot, between the middles of its
    ends; 0 for a hole.
    """

    diameter: Positive
    play: float
    flat: Length = 0.0
    keyway: tuple[Length, Length] = (0.0, 0.0)
    travel: Length = 0.0


@record(checked=True, eq=False)
class Part:
    """A plate, flat or with a section that moves as it goes up.

    name: also its file name. outline and holes: closed curves in the part's own frame, mm, in either
    direction; thickness, mm. layer: the operation that cuts the outline. count: how many to make. marks:
    open or closed curves engraved within the outline. body: whose motion it follows, by the name that the
    mechanism gives it; "" for a part that belongs to no motion, as a drawing. hole_names: what is engraved beside
    each hole, such as the letter of a joint; empty for none. twist: of a helical gear; None for what goes straight up.
    fits: of holes, in their order, None for one that nothing goes through; as far as there are any.
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

    def __post_init__(self) -> None:
        check_names("name", [self.name], "a part")
        if len(self.fits) > len(self.holes):
            raise DesignError("fits", f"found {len(self.fits)} for {len(self.holes)} holes", "give one for each hole")

    def _repr_svg_(self) -> str | None:
        return still(self, (self.outline, *self.holes), self.marks)


@record
class Bought:
    """A line of the bill: what is bought, or cut from a rod, how many, and what for.

    joints: by the letters at their holes, or by the names of the parts that turn on it.
    """

    name: str
    count: int
    joints: tuple[str, ...]

    @property
    def told(self) -> dict[str, object]:
        """The same as plain values for a file."""
        return {"name": self.name, "count": self.count, "joints": list(self.joints)}
