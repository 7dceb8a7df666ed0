"""What is measured: a family of methods that find the same thing, each at its own cost and with its own error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from ..arguments import check_fields
from ..brief import one_line
from ..errors import DesignError
from ..plane.vec import Real

P = TypeVar("P")
R = TypeVar("R")


@dataclass(frozen=True, eq=False)
class Method(Generic[P, R]):
    """One way to a family's results.

    make: takes the family's problem and a setting, gets ready whatever is not to be timed, and gives the call that is:
    it takes nothing and returns the results. about: how it goes, in a sentence or two, with what was got ready
    beforehand and the source. settings: what it is measured at, from coarse to fine, such as steps or tolerances; left
    out where there is nothing to set. setting: what they are, with the unit, as `step, deg`.
    because: of a default, why it is the default; of all others empty. despite: of a default that is not on the front,
    why it is the default all the same. slow: takes so long that a quick chart leaves it out.
    """

    name: str
    about: str
    make: Callable[[P, float], Callable[[], R]]
    setting: str = ""
    settings: tuple[float, ...] = ()
    because: str = ""
    despite: str = ""
    slow: bool = False

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)
        if bool(self.setting) != bool(len(self.settings)):
            raise DesignError("settings", f"found {len(self.settings)} of {self.setting!r}", "give both or neither")

    @property
    def is_default(self) -> bool:
        """Whether the library takes this way when it is not told otherwise."""
        return bool(self.because)


@dataclass(frozen=True, eq=False)
class MethodFamily(Generic[P, R]):
    """All ways to one thing, with a problem to try them on and a reference to judge them by.

    name: as the command takes it; title, about: what is found, of what, in plain words. problem: makes the problem,
    with its reference; it is called once a chart, not timed. count: from problem and results, how many results there
    are, each one `per`, such as `pose`. error: from problem and results, the error of each, (results,) or fewer, in
    `unit`, 0 or more, nan or inf where the method failed; not timed. reference: how the right results are known.
    floor: an error below which there is only rounding: smaller ones count as equal. weigh: from problem and results,
    what they cost whoever goes on with them, such as how many vertices they have; weighed: what that is; left out where
    time alone counts.
    """

    name: str
    title: str
    about: str
    per: str
    unit: str
    reference: str
    floor: float
    problem: Callable[[], P]
    count: Callable[[P, R], int]
    error: Callable[[P, R], Real]
    methods: tuple[Method[P, R], ...]
    weighed: str = ""
    weigh: Callable[[P, R], float] | None = None

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)
        names = [method.name for method in self.methods]
        if len(set(names)) < len(names):
            raise DesignError("methods", f"found twins among {', '.join(names)}", "give each method its own name")
