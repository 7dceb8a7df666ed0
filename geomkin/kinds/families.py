"""What goals have in common whose linkages are a family: their keys, the best of it, and what it was chosen from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..cached import cached_property
from ..errors import DesignError
from ..judge.linkage import LEAST_TRANSMISSION_ANGLE_DEG
from ..plane.vec import Real, rounded
from ..recipe.settings import Drive, Files
from ..scene import Choice, Limit, Plot
from ..shop.linkage.stock import LinkStock
from ..sizes import check_sizes, entry, quantity
from ..synthesis.rockers.families import RATIO, AbstractMember
from ..table import Column, Table
from .linkage_goals import AbstractLinkageGoal, choose_entry

# What a search in a family finds.
M = TypeVar("M", bound=AbstractMember)
M_co = TypeVar("M_co", bound=AbstractMember, covariant=True)
# deg. What a simulated swing or turn may miss of the one wanted: rounding is less, of linkages at the edge of what
# there is a little less; whoever cuts them misses more by a thousand times. Derived here.
MISSED_DEG = 1e-4
# Members of a family that are ranked besides the best. More are only more of the same between them.
OTHERS = 19


def ratio_entry() -> Any:
    """How unlike the links of the best may be."""
    return quantity(
        "longest link over the shortest; 100 where left out", default=None, example=None, above=1, at_most=1e6
    )


def turn_entry(example: float) -> Any:
    """The crank's turn in the stroke that is told."""
    meaning = "crank's turn in that stroke; 180 where neither this nor time_ratio is given"
    return quantity(meaning, "deg", default=None, example=example, above=0, below=360)


def time_ratio_entry() -> Any:
    """The same as a ratio of times."""
    return quantity("time of that stroke over the time of the stroke back", default=None, above=0, at_most=1e6)


class AbstractTimed:
    """What is wanted of a crank that takes its time for a stroke: its turn, or a ratio of times."""

    crank_turn_deg: float | None
    time_ratio: float | None

    @property
    def turn_key(self) -> str:
        """The key that tells the turn."""
        return "crank_turn_deg" if self.time_ratio is None else "time_ratio"

    @property
    def turn_deg(self) -> float:
        """The crank's turn in that stroke, deg."""
        turn, ratio = self.crank_turn_deg, self.time_ratio
        if ratio is None:
            return 180.0 if turn is None else turn
        if turn is not None:
            problem = "is given besides crank_turn_deg"
            raise DesignError("time_ratio", problem, "give one of them, which tells the other")
        return 360 * ratio / (1 + ratio)


def missed(found: float, wanted: float) -> float:
    """How far what was simulated is off, without the last digits, in which processors differ."""
    return float(rounded(abs(found - wanted), 9))


class Wanted(Protocol[M_co]):
    """What is wanted of a linkage that has a family: all that do it, told apart by one angle."""

    @property
    def largest_ratio(self) -> float | None: ...

    @property
    def is_free(self) -> bool:
        """Whether the best of the family is looked for."""

    def search(self, free_angle_deg: float | None = None) -> M_co:
        """The best or the one with the sizes that are given, or the one at a free angle."""


@dataclass(frozen=True, kw_only=True)
class AbstractFamilyGoal(AbstractLinkageGoal[M]):
    """A goal that takes the best of a family, and ranks others of it."""

    kind: str
    wanted: Wanted[M]
    choose: int = choose_entry()
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()

    @cached_property
    def ranked(self) -> Sequence[M]:
        best = self.wanted.search()
        if not self.wanted.is_free:
            return (best,)
        step = -(-len(best.family.free_angle_deg) // OTHERS)
        others = [self.wanted.search(float(angle)) for angle in best.family.free_angle_deg[step // 2 :: step]]
        most = RATIO if self.wanted.largest_ratio is None else self.wanted.largest_ratio
        return best, *sorted((one for one in others if one.ratio <= most and not one.defects), key=self.rank)

    def rank(self, one: M) -> tuple[float, ...]:
        """The less, the better."""
        return (-float(one.transmission_angle_deg),)

    @property
    def way(self) -> tuple[float, float]:
        """The full turn."""
        return 0.0, 360.0

    @property
    def choice(self) -> Choice:
        return family_choice(self.found, self.wanted.largest_ratio)

    @property
    def notes(self) -> Mapping[str, object]:
        ends = [float(f"{end:.10g}") for end in self.ranked[0].family.range_deg]
        return {"family": {"free_angle_deg": ends}, **super().notes}


def family_choice(found: AbstractMember, largest_ratio: float | None) -> Choice:
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
