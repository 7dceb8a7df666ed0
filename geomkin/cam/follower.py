"""What rides on a cam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..sizes import FARTHEST, check_sizes, quantity


@dataclass(frozen=True)
class TranslatingRoller:
    """A roller that moves along a straight line parallel to y; radius 0 is a knife edge."""

    roller_radius: float = quantity("radius of the roller", "mm", at_least=0, at_most=FARTHEST, example=10)
    offset: float = quantity(
        "distance of the follower's line from the cam axis, positive to +x",
        "mm",
        default=0.0,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    kind: Literal["translating-roller"] = "translating-roller"

    def __post_init__(self) -> None:
        check_sizes(self)
