"""Shafts of a machine: which mechanism turns which, their exact speeds, and the period of the whole."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm

import numpy as np

from ..core.errors import DesignError, shown
from ..core.records import record
from ..model.motor import RotatingBody
from ..plane.vec import Real
from ..recipe.search import did_you_mean

# Rows over the period: the fewest, the most, and those of a turn of the fastest crank or cam. A page shows no more rows
# than the most; with fewer for a turn a crank jumps.
FEWEST_FRAMES, MOST_FRAMES, FRAMES_PER_TURN = 240, 1000, 72
# Most turns of a crank or cam in a period; with more there are fewer than 25 rows for each.
MOST_TURNS = 40
# Most turns of the fastest gear in a period of gears alone; with more there are fewer than 4 rows for each.
MOST_GEAR_TURNS = 250
# Most turns of any gear in a period; with more, its angle loses digits that a drawing shows.
MOST_EXACT_TURNS = 1_000_000

Bodies = Mapping[str, RotatingBody]


@record
class Shaft:
    """A shaft that joins a body of one mechanism, which turns it, to the drivers of others.

    Parameters
    ----------
    mechanism, body : str
        The mechanism that turns the shaft, and its body on it.
    turned : tuple of str
        Names of the mechanisms whose drivers are on the shaft.
    """

    mechanism: str
    body: str
    turned: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.mechanism}/{self.body}"


@record(eq=False)
class ShaftGraph:
    """Which mechanism turns which.

    Parameters
    ----------
    bodies : dict of str to dict of str to RotatingBody
        Rotating bodies of each mechanism, the driver first.
    turned_by : dict of str to str or None
        For each mechanism the body that turns it, as `mechanism.body`; None for the driven mechanism.
    """

    bodies: Mapping[str, Bodies]
    turned_by: Mapping[str, str | None]
    # Shaft by the mechanism that it turns.
    sources: Mapping[str, tuple[str, str]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "sources", {n: self._source(n, by) for n, by in self.turned_by.items() if by})
        drivers = [name for name in self.turned_by if name not in self.sources]
        for name in self.turned_by:
            if (chain := self._chain(name))[-1] in chain[:-1]:
                circle = " by ".join(chain[chain.index(chain[-1]) :])
                remedy = "omit turned_by of the one that a motor or a hand drives"
                raise DesignError(_key(chain[-1]), f"the mechanisms turn each other: {circle}", remedy, "conflict")
        if len(drivers) > 1:
            problem = f"is missing, and {drivers[0]} is the mechanism that a motor or a hand drives"
            others = next(iter(self.bodies[drivers[0]]))
            raise DesignError(_key(drivers[1]), problem, f'give a body, such as "{drivers[0]}.{others}"', "missing-key")

    def _source(self, name: str, by: str) -> tuple[str, str]:
        """The mechanism and the body that turn a mechanism."""
        mechanism, _, body = by.partition(".")
        found, key = f"found {shown(by)}", _key(name)
        if mechanism not in self.bodies:
            others = " or ".join(n for n in self.bodies if n != name)
            remedy = f"{did_you_mean(mechanism, self.bodies)}give a body of {others}"
            raise DesignError(key, f"{found}, but no mechanism has this name", remedy, "unknown-key")
        bodies = self.bodies[mechanism]
        if body not in bodies:
            offered = " or ".join(f'"{mechanism}.{other}"' for other in bodies)
            problem = f"{found}, but no body of {mechanism} has this name and turns evenly about a fixed axis"
            raise DesignError(key, problem, f"{did_you_mean(body, bodies)}give {offered}", "unknown-key")
        return mechanism, body

    def _chain(self, name: str) -> list[str]:
        """A mechanism, the one that turns it and so on, until the driven one or until one repeats."""
        chain = [name]
        while (source := self.sources.get(chain[-1])) is not None:
            chain.append(source[0])
            if chain[-1] in chain[:-1]:
                break
        return chain

    @property
    def driver(self) -> str:
        """The mechanism that a motor or a hand drives."""
        return next(name for name in self.turned_by if name not in self.sources)

    @cached_property
    def order(self) -> tuple[str, ...]:
        """All mechanisms, each after the one that turns it."""
        return tuple(sorted(self.turned_by, key=lambda name: len(self._chain(name))))

    @cached_property
    def shafts(self) -> tuple[Shaft, ...]:
        """The shafts that join mechanisms."""
        turned: dict[tuple[str, str], list[str]] = {}
        for name, source in self.sources.items():
            turned.setdefault(source, []).append(name)
        return tuple(Shaft(*source, tuple(names)) for source, names in turned.items())

    @cached_property
    def speeds(self) -> Mapping[str, Fraction]:
        """Rotations of the driver of each mechanism for one of the machine's driver, exact."""
        speeds: dict[str, Fraction] = {}
        for name in self.order:
            if name in self.sources:
                mechanism, body = self.sources[name]
                shaft = speeds[mechanism] * self.bodies[mechanism][body].speed
                speeds[name] = shaft / next(iter(self.bodies[name].values())).speed
            else:
                speeds[name] = Fraction(1)
        return speeds

    def _body_speeds(self, wheels: bool) -> list[Fraction]:
        return [
            abs(self.speeds[name] * body.speed)
            for name, bodies in self.bodies.items()
            for body in bodies.values()
            if body.is_wheel == wheels
        ]

    @cached_property
    def period(self) -> Fraction:
        """Rotations of the machine's driver after which all cranks and cams are where they began.

        In a machine of gears alone, those after which all gears are, or as many as a scene may have.

        Raises
        ------
        DesignError
            If a crank, cam or gear turns too often in it; names the numbers.
        """
        speeds, wheels = self._body_speeds(wheels=False), self._body_speeds(wheels=True)
        if not speeds:
            return min(common_period(wheels), MOST_GEAR_TURNS / max(wheels))
        period = common_period(speeds)
        for what, each, most in (("crank or cam", speeds, MOST_TURNS), ("gear", wheels, MOST_EXACT_TURNS)):
            if (turns := period * max(each, default=Fraction(0))) > most:
                problem = f"a {what} turns {float(turns):,.6g} times until all cranks and cams are where they began"
                remedy = f"choose numbers of teeth with simpler ratios, so that it turns at most {most:,} times"
                raise DesignError("mechanisms", problem, remedy, "too-much-work")
        return period

    @property
    def is_cyclic(self) -> bool:
        """Whether all cranks and cams, or in their absence all gears, are where they began after the period."""
        speeds = self._body_speeds(wheels=False) or self._body_speeds(wheels=True)
        return all((self.period * speed).denominator == 1 for speed in speeds)

    @cached_property
    def turns(self) -> Real:
        """Rotations of the machine's driver at the frames, (frames,), from 0 to the period."""
        fastest = max(self._body_speeds(wheels=False), default=Fraction(0)) * self.period
        frames = min(MOST_FRAMES, max(FEWEST_FRAMES, int(FRAMES_PER_TURN * fastest)))
        return float(self.period) * np.arange(frames + 1) / frames


def common_period(speeds: Iterable[Fraction]) -> Fraction:
    """The least number of turns of a driver after which bodies of these speeds have made whole turns."""
    speeds = list(speeds)
    return Fraction(lcm(*(v.denominator for v in speeds)), gcd(*(v.numerator for v in speeds)))


def _key(name: str) -> str:
    return f"mechanisms.{name}.turned_by"
