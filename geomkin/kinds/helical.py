"""What recipes of involute gears have in common: their teeth may lie on helices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from ..errors import DesignError
from ..gear.helix import Hand, Helix, helix_angle
from ..recipe.recipe import AbstractRecipe
from ..sizes import check_sizes, entry


@dataclass(frozen=True, kw_only=True)
class AbstractHelicalRecipe(AbstractRecipe):
    """What recipes of involute gears have in common."""

    advice: ClassVar[str] = (
        "Where teeth lie on helices, all sizes, module first, are those of the transverse section, square to the axis, "
        "which drawings show."
    )

    kind: str
    helix_angle_deg: float = helix_angle()
    hand: Hand = entry(
        "hand of the helices, of gears in mesh that of the one that drives; the others follow", default="right"
    )
    herringbone: bool = entry("the upper half of the face has the other hand", default=False)

    def __post_init__(self) -> None:
        check_sizes(self)
        self.helix  # noqa: B018  refuses a herringbone of straight teeth

    @property
    def helix(self) -> Helix:
        """Of the gear that drives."""
        return Helix(self.helix_angle_deg, self.hand, self.herringbone)

    @property
    def subtitle(self) -> str:
        """That of the kind, with the form of the teeth where they are not straight."""
        told = self.about()
        if not self.helix_angle_deg:
            return told
        form = "herringbone" if self.herringbone else "helical"
        if "spur gear" in told:
            return told.replace("spur gear", f"{form} gear")
        return f"{told} Its teeth are {'herringbones' if self.herringbone else form}."

    def check_faces(self, thicknesses: Mapping[str, float]) -> None:
        """Refuse a herringbone whose faces bend at different heights. thicknesses: of each stock, mm, by its key."""
        (_, first), *others = thicknesses.items()
        for key, thickness in others:
            if self.herringbone and thickness != first:
                raise DesignError(
                    f"{key}.thickness",
                    f"found {thickness:g} mm beside {first:g} mm: the two bends of a herringbone do not meet",
                    f"give {first:g} mm",
                )
