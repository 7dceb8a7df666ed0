"""The dwell of a linkage's output in a recipe: its band, and its entries in the summary."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ..dwell import longest_dwell
from ..linkage import Linkage
from ..motion import Motion, is_translating, on_ground


@record(checked=True)
class DwellBand:
    """The band within which an output counts as standing still, in a recipe."""

    band_deg: float | None = quantity(
        "largest less smallest angle of the output in its dwell; for an output that turns",
        "deg",
        default=None,
        above=0,
        at_most=360,
        example=0.5,
    )
    band_mm: float | None = quantity(
        "largest less smallest displacement of the output in its dwell; for an output that slides",
        "mm",
        default=None,
        above=0,
        at_most=FARTHEST,
        example=0.5,
    )
    output: str = entry("the body; by default the last one on the ground that does not drive", default="")

    def body(self, linkage: Linkage) -> str:
        """Name of the output; DesignError if it does not move, or there is none."""
        moving = list(linkage.bodies)[1:]
        driven = [name for name in moving if name in on_ground(linkage) and name != linkage.driver]
        if self.output in moving or (driven and not self.output):
            return self.output or driven[-1]
        raise DesignError(
            "dwell.output", f"found {shown(self.output)}", f"give one of {', '.join(moving)}", "unknown-key"
        )

    def found(self, motion: Motion) -> Mapping[str, object]:
        """The longest dwell, as entries of the summary."""
        output = self.body(motion.linkage)
        slides = is_translating(motion, output)
        unit, factor = ("mm", 1.0) if slides else ("deg", 180 / np.pi)
        band = self.band_mm if slides else self.band_deg
        if band is None:
            verb = "slides" if slides else "turns"
            raise DesignError(f"dwell.band_{unit}", "is missing", f"give band_{unit}: {output} {verb}", "missing-key")
        by, driver_factor = ("mm", 1.0) if motion.linkage.driven_slider else ("deg", 180 / np.pi)
        dwell = longest_dwell(motion, output, band / factor)
        values = {
            f"from_{by}": dwell.start * driver_factor,
            f"to_{by}": dwell.end * driver_factor,
            f"driver_range_{by}": dwell.range * driver_factor,
            f"least_{unit}": dwell.low * factor,
            f"greatest_{unit}": dwell.high * factor,
        }
        rounded = {name: to_digits(value, 10) for name, value in values.items()}
        return {"output": output, f"band_{unit}": band, **rounded}
