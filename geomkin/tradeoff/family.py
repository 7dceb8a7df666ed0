"""How a family of methods is stated: a problem, the error against its exact answer, and methods as functions."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Real


@record(checked=True, eq=False)
class Method:
    """A method of a family; `method` makes one of a function.

    Parameters
    ----------
    name : str
        Its name in charts.
    about : str
        How it works, in one or two sentences, with its preparation and its source.
    make : callable
        From the family's problem and a setting, after all preparation that is not timed, to the timed call, which takes
        nothing and returns the results.
    setting : str
        Name of the setting with its unit, such as `step, deg`; "" if there is none.
    settings : tuple of float
        Values at which it is measured, from coarse to fine; empty if there is no setting.
    rationale : str
        Reason why the library uses it by default; "" for all other methods.
    caveat : str
        Reason why it is the default although it is not on the Pareto front; "" otherwise.
    slow : bool
        Whether a quick chart leaves it out.

    Raises
    ------
    DesignError
        If only one of `setting` and `settings` is given.
    """

    name: str
    about: str
    make: Callable[[Any, float], Callable[[], Any]]
    setting: str = ""
    settings: tuple[float, ...] = ()
    rationale: str = ""
    caveat: str = ""
    slow: bool = False

    def __post_init__(self) -> None:
        if bool(self.setting) != bool(len(self.settings)):
            problem = f"found {len(self.settings)} of {self.setting!r}"
            raise DesignError("settings", problem, "give both or neither", "conflict")

    @property
    def is_default(self) -> bool:
        """Whether the library uses this method by default."""
        return bool(self.rationale)


def method(
    name: str, setting: str = "", settings: tuple[float, ...] = (), *, prepared: bool = False, **options: Any
) -> Callable[[Callable[..., Any]], Method]:
    """Make a method of the function below, which takes the problem and the setting if there is one.

    The function's docstring describes the method. The whole function is timed; if `prepared`, it does what is not timed
    and returns the function that is. `options` are the other fields of `Method`.
    """

    def decorate(function: Callable[..., Any]) -> Method:
        def make(problem: Any, value: float) -> Callable[[], Any]:
            bound = partial(function, problem, value) if setting else partial(function, problem)
            return bound() if prepared else bound

        return Method(name, " ".join((function.__doc__ or "").split()), make, setting, settings, **options)

    return decorate


@record(checked=True, eq=False)
class MethodFamily:
    """All methods for one kind of result, with a test problem and a reference.

    Parameters
    ----------
    name : str
        Its name, as on the command line.
    title, about : str
        The kind of result and the problem, in plain words.
    per : str
        Name of one result, such as `pose`.
    unit : str
        Unit of the errors.
    reference : str
        How the exact results are known.
    floor : float
        Error below which there is only rounding; smaller errors count as equal.
    problem : callable
        Makes the problem with its exact answer, once per chart and not timed.
    error : callable
        From problem and results to the errors, not negative, nan or inf if the method failed.
    methods : tuple of Method
        The methods, with different names.
    count : callable, optional
        From problem and results to the number of results; by default the number of errors.
    weighed : str
        Name of a further cost of the results, such as vertices; "" if only time counts.
    weigh : callable, optional
        From problem and results to that cost.

    Raises
    ------
    DesignError
        If two methods have the same name.
    """

    name: str
    title: str
    about: str
    per: str
    unit: str
    reference: str
    floor: float
    problem: Callable[[], Any]
    error: Callable[[Any, Any], Real]
    methods: tuple[Method, ...]
    count: Callable[[Any, Any], int] | None = None
    weighed: str = ""
    weigh: Callable[[Any, Any], float] | None = None

    def __post_init__(self) -> None:
        names = [method.name for method in self.methods]
        if len(set(names)) < len(names):
            problem = f"found twins among {', '.join(names)}"
            raise DesignError("methods", problem, "give each method its own name", "conflict")
