"""What a mechanism is made of: parts, as a cutter or a printer needs to know them, and things that are bought."""

from __future__ import annotations

from dataclasses import dataclass

from .arguments import check_fields
from .brief import one_line
from .display import still
from .names import check_names
from .plane.curve import AbstractCurve


@dataclass(frozen=True, eq=False)
class Part:
    """A flat plate.

    name: also its file name. outline and holes: closed curves in the part's own frame, mm, in either
    direction; thickness, mm. layer: the operation that cuts the outline. count: how many to make. marks:
    open or closed curves engraved within the outline. body: whose motion it follows, by the name that the
    mechanism gives it; "" for a part that belongs to no motion, as a drawing. hole_names: what is engraved beside
    each hole, such as the letter of a joint; empty for none.
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

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)
        check_names("name", [self.name], "a part")

    def _repr_svg_(self) -> str | None:
        return still(self, (self.outline, *self.holes), self.marks)


@dataclass(frozen=True)
class Bought:
    """A line of the bill: what is bought, or cut from a rod, how many, and what for.

    joints: by the letters at their holes, or by the names of the parts that turn on it.
    """

    name: str
    count: int
    joints: tuple[str, ...]

    __repr__ = one_line

    @property
    def told(self) -> dict[str, object]:
        """The same as plain values for a file."""
        return {"name": self.name, "count": self.count, "joints": list(self.joints)}
