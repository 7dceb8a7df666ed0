"""What a linkage of a family was chosen from, as it is plotted: all of them along the angle that stays free."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..judge.linkage import LEAST_TRANSMISSION_ANGLE_DEG
from ..plane.vec import Real
from ..scene import Choice, Limit, Plot
from ..synthesis.rockers.crank_rockers import CrankRocker
from ..synthesis.rockers.double_rockers import DoubleRocker
from ..synthesis.rockers.strokes import StrokeCrank
from ..table import Column, Table


def family_choice(found: CrankRocker | DoubleRocker | StrokeCrank, largest_ratio: float | None) -> Choice:
    """Transmission angles, ratios of the links and their lengths along the family, with the one that was found.

    largest_ratio: of the longest link over the shortest, as it was asked for; beyond it none was taken.
    """
    family = found.family
    angle = np.append(family.free_angle_deg, found.free_angle_deg)
    order = np.argsort(angle, kind="stable")
    chosen = int(np.flatnonzero(order == len(angle) - 1)[0])

    def along(members: ArrayLike, own: float) -> Real:
        every: Real = np.append(np.broadcast_to(np.asarray(members), family.free_angle_deg.shape), own)[order]
        return every

    def made(values: Real) -> Real:
        return np.where(np.arange(len(values)) == chosen, values, np.nan)

    lengths = {name: along(getattr(family.linkage, name), length) for name, length in found.lengths.items()}
    links = np.array([row for name, row in lengths.items() if name != "offset"])
    ratio = links.max(axis=0) / links.min(axis=0)
    transmission = along(family.transmission_angle_deg, found.transmission_angle_deg)
    columns = (
        Column("free_angle", "deg", "angle that stays free", angle[order]),
        Column("every_one", "deg", "least transmission angle of each", transmission),
        Column("made", "deg", "least transmission angle of the one that is made", made(transmission)),
        Column("ratio_of_every_one", "", "longest link over the shortest, of each", ratio),
        Column("ratio_of_the_made", "", "longest link over the shortest, of the one that is made", made(ratio)),
        *(Column(name, "mm", name, row) for name, row in lengths.items()),
    )
    at = {column.name: column.header for column in columns}
    least = LEAST_TRANSMISSION_ANGLE_DEG
    plots = (
        Plot(
            "least transmission angle",
            (at["every_one"], at["made"]),
            (Limit(least, f"at least {least:g} deg"),),
        ),
        Plot(
            "longest link over the shortest",
            (at["ratio_of_every_one"], at["ratio_of_the_made"]),
            () if largest_ratio is None else (Limit(largest_ratio, f"at most {largest_ratio:g}"),),
        ),
        Plot("lengths", tuple(at[name] for name in lengths)),
    )
    return Choice(Table(columns), chosen, plots)
