"""The dwell of a linkage's output in a recipe: within what band it is sought, and what the summary has of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..brief import one_line
from ..errors import DesignError, shown
from ..linkage.dwell import longest_dwell
from ..linkage.linkage import Linkage
from ..linkage.motion import Motion, goes_without_turning, on_ground
from ..sizes import FARTHEST, check_sizes, entry, quantity


@dataclass(frozen=True)
class DwellBand:
    """Within what an output counts as standing still."""

    band: float = quantity(
        "greatest less least of the output's values in its dwell: deg where it turns, mm where it slides",
        above=0,
        at_most=FARTHEST,
        example=0.5,
    )
    output: str = entry("the body; the last one on the ground that does not drive where left out", default="")

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_sizes(self)

    def body(self, linkage: Linkage) -> str:
        """The output's name. DesignError for one that does not move, and where there is none."""
        moving = list(linkage.bodies)[1:]
        driven = [name for name in moving if name in on_ground(linkage) and name != linkage.driver]
        if self.output in moving or (driven and not self.output):
            return self.output or driven[-1]
        raise DesignError("dwell.output", f"found {shown(self.output)}", f"give one of {', '.join(moving)}")

    def found(self, motion: Motion) -> Mapping[str, object]:
        """The longest dwell, as the summary has it."""
        output = self.body(motion.linkage)
        unit, factor = ("mm", 1.0) if goes_without_turning(motion, output) else ("deg", 180 / np.pi)
        by, turn = ("mm", 1.0) if motion.linkage.driven_slider else ("deg", 180 / np.pi)
        dwell = longest_dwell(motion, output, self.band / factor)
        values = {
            f"from_{by}": dwell.start * turn,
            f"to_{by}": dwell.end * turn,
            f"driver_range_{by}": dwell.range * turn,
            f"least_{unit}": dwell.low * factor,
            f"greatest_{unit}": dwell.high * factor,
        }
        rounded = {name: float(f"{value:.10g}") for name, value in values.items()}
        return {"output": output, f"band_{unit}": self.band, **rounded}
