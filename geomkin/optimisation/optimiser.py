"""Optimisation of a recipe: the values of some of its keys that make an objective least within constraints."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import field, replace
from pathlib import Path
from typing import Annotated, Any, NoReturn, overload

import numpy as np

from ..build import Readable, valid_recipe_name
from ..core.arguments import ArgumentType, PositiveFloat, checked, is_real, whole_between
from ..core.errors import DesignError, RecipeError, printable, shown
from ..core.field_visitor import key_parts, texts_by_key
from ..core.fields import allowed
from ..core.names import PathName
from ..core.processes import Runner, by
from ..core.processes import report as report_progress
from ..core.records import record
from ..core.units import MM, UNITS, marked
from ..export.summary import check_file_names, write_whole
from ..model.check import Check
from ..recipe.keys import VariedRecipe, varied
from ..recipe.kinds import kind_names, recipe_class
from ..recipe.load import shown_numbers, to_toml
from ..recipe.reader import field_of
from ..recipe.recipe import AbstractRecipe
from .designs import NO_VIOLATION, Target, Trials, TriedDesign, objective, parsed_constraint
from .search import MOST_OBJECTIVES, Box, FrontDesign, ParetoFront, front_of, search, write_front

# Largest number of combinations of whole numbers, each of which is searched.
MOST_COMBINATIONS = 10_000
# Distance from an end of its range, as a share of it, at which a value counts as the end.
AT_END = 1e-6
# End of the name of the written recipe.
ENDING = ".optimum.toml"

Ranges = Annotated[
    Mapping[str, tuple[float, float]],
    ArgumentType(
        lambda given: (
            isinstance(given, Mapping)
            and all(isinstance(key, str) for key in given)
            and all(
                isinstance(pair, (tuple, list)) and len(pair) == 2 and all(map(is_real, pair))
                for pair in given.values()
            )
        ),
        'a table of keys, each with its least and greatest value, such as {"linkage.rocker": (40, 90)}',
    ),
]
Texts = Annotated[
    str | Sequence[str],
    ArgumentType(
        lambda given: (
            isinstance(given, str) or (isinstance(given, (list, tuple)) and all(isinstance(n, str) for n in given))
        ),
        "a text or a row of texts",
    ),
]


@record(eq=False)
class OptimisedDesign:
    """The best design that an optimisation found.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe with the best values; `gk.make` makes it, `gk.recipe.to_toml` writes it.
    values : mapping of str to float or int
        The best value of each key.
    minimised : str
        The formula of the objective.
    objective : float
        Value of the objective.
    constraints : tuple of Check
        Each constraint with its value and limit.
    evaluations : int
        Number of designs that were tried.
    cut_short : bool
        Whether the time limit or an interruption ended the search.
    at_ends : tuple of str
        Keys whose best value is an end of their range, so that another range may have a better one.
    files : mapping of Path to int
        Written files with their size in bytes.
    """

    recipe: AbstractRecipe
    values: Mapping[str, float]
    minimised: str
    objective: float
    constraints: tuple[Check, ...]
    evaluations: int
    cut_short: bool = False
    at_ends: tuple[str, ...] = ()
    files: Mapping[Path, int] = field(default_factory=dict)

    @property
    def lines(self) -> list[str]:
        """Values, objective and constraints as lines of text."""
        results = {**self.values, self.minimised: self.objective}
        verdicts = [f"  {'pass' if check.passed else 'FAIL'}  {check}" for check in self.constraints]
        ends = ", ".join(map(printable, self.at_ends))
        note = f"  note  {ends}: best at an end of the range; another range may have a better design"
        values = (f"{printable(name)} = {value:.8g}" for name, value in results.items())
        return [*values, *verdicts, *[note] * bool(ends)]


@overload
def optimise(
    recipe: AbstractRecipe | Readable,
    vary: Mapping[str, tuple[float, float]] | None,
    minimise: str,
    subject_to: str | Sequence[str] | None = None,
    starts: int = 6,
    seed: int = 0,
    time_limit: float = 60,
    out: PathName | None = None,
    executor: Executor | None = None,
) -> OptimisedDesign: ...
@overload
def optimise(
    recipe: AbstractRecipe | Readable,
    vary: Mapping[str, tuple[float, float]] | None = None,
    minimise: str | Sequence[str] | None = None,
    subject_to: str | Sequence[str] | None = None,
    starts: int = 6,
    seed: int = 0,
    time_limit: float = 60,
    out: PathName | None = None,
    executor: Executor | None = None,
) -> OptimisedDesign | ParetoFront: ...
@checked
def optimise(
    recipe: AbstractRecipe | Readable,
    vary: Ranges | None = None,
    minimise: Texts | None = None,
    subject_to: Texts | None = None,
    starts: Annotated[int, whole_between(1, 1000)] = 6,
    seed: Annotated[int, whole_between(0, 2**32 - 1)] = 0,
    time_limit: PositiveFloat = 60,
    out: PathName | None = None,
    executor: Executor | None = None,
) -> OptimisedDesign | ParetoFront:
    """Find the values of a recipe's keys that make a result least within constraints.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or anything that `gk.load` reads. Its table `[optimise]` gives the next three arguments if they are
        omitted.
    vary : mapping of str to (low, high), optional
        Dotted keys of numbers, such as "linkage.crank", with their ranges in the unit of the key. Keys of whole
        numbers, such as "gear.teeth", take every value of their range.
    minimise : str or sequence of str, optional
        The objective: a formula of ids of columns and checks with `min`, `max`, `mean`, `range` and `rms`, such as
        "max(rocker_omega)", or "-min(transmission_angle)" for a maximum. "rms(distance(coupler_point, [[10, 20],
        [15, 22]]))" measures points from the path of a traced point, mm. Two to four of them give the Pareto front.
    subject_to : str or sequence of str, optional
        Constraints, such as "min(transmission_angle) >= 40".
    starts : int
        Number of gradient searches, 1 to 1000. With 1 the only one starts from the recipe's own
        values.
    seed : int
        Seed of the random designs.
    time_limit : float
        Longest time, s. When it is over, or at Ctrl-C, the best design so far is returned.
    out : str or Path, optional
        Folder for `<name>/<name>.optimum.toml`; for `<name>.front.csv`, `.svg` and `.html` and a recipe of each
        design if there are several objectives. By default nothing is written.
    executor : Executor, optional
        Of `concurrent.futures`, or of a cluster with the same interface, such as Dask's `client.get_executor()`. By
        default this process computes the designs. The result is the same.

    Returns
    -------
    OptimisedDesign or ParetoFront
        The best design; with several objectives up to 21 designs of which none is better than another in all of them.

    Raises
    ------
    RecipeError, FileError
        As for `gk.load`.
    DesignError
        If a key, range or formula is wrong, no design works, or none meets the constraints; the message then names
        the constraint that is missed and by how much. If the executor fails.

    See Also
    --------
    sweep, load

    Notes
    -----
    Gradient searches (sequential quadratic programming) start from the best of random designs and need the package
    nlopt. Their gradients are difference quotients. A global optimum is likely, and not proved. With several objectives
    each is minimised alone, then the largest of all, from evenly spaced points between these optima.

    Examples
    --------
    >>> import geomkin as gk
    >>> best = gk.optimise(
    ...     {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}},
    ...     vary={"linkage.coupler": (60, 120), "linkage.rocker": (60, 120)},
    ...     minimise="-min(transmission_angle)",
    ...     starts=1,
    ... )
    >>> round(-best.objective, 2)
    56.6
    """
    return optimised(recipe, vary, minimise, subject_to, starts, seed, time_limit, out, by(executor))


def optimised(
    recipe: AbstractRecipe | Readable,
    vary: Mapping[str, tuple[float, float]] | None,
    minimise: str | Sequence[str] | None,
    subject_to: str | Sequence[str] | None,
    starts: int,
    seed: int,
    time_limit: float,
    out: str | Path | None,
    run: Runner,
) -> OptimisedDesign | ParetoFront:
    """An optimisation whose jobs are done by `run`; see `optimise`."""
    source, stem = varied(recipe)
    name = valid_recipe_name(source.file, stem)
    arguments: dict[str, Any] = {"vary": vary, "minimise": minimise, "subject_to": subject_to}
    omitted = [argument for argument, value in arguments.items() if value is None]
    table = source.opened({}).optimise if omitted else None
    folder = None if out is None else Path(out) / name
    copies = {} if folder is None else source.copies(folder)
    if folder is not None:
        check_file_names(folder, (f"{name}{ENDING}", *copies))
    try:
        if table is not None:
            given = {"vary": ranges_of(table.vary), "minimise": table.minimise, "subject_to": table.subject_to}
            arguments |= {argument: given[argument] for argument in omitted}
        found = _optimised(source, **arguments, starts=starts, seed=seed, time_limit=time_limit, run=run)
    except DesignError as error:
        if table is None or error.field not in omitted:
            raise
        raise error.named(f"optimise.{error.field}") from None
    if folder is None:
        return found
    if isinstance(found, ParetoFront):
        return replace(found, files=write_front(found, folder, name, copies))
    contents = {f"{name}{ENDING}": to_toml(found.recipe).encode(), **copies}
    write_whole(folder, contents)
    return replace(found, files={folder / file: len(content) for file, content in contents.items()})


def _optimised(
    source: VariedRecipe,
    vary: Mapping[str, tuple[float, float]] | None,
    minimise: str | Sequence[str] | None,
    subject_to: str | Sequence[str] | None,
    starts: int,
    seed: int,
    time_limit: float,
    run: Runner,
) -> OptimisedDesign | ParetoFront:
    if not vary:
        remedy = "give a key with its range, such as linkage.crank from 20 to 40, or a table [optimise] in the recipe"
        raise DesignError("vary", "found none", remedy, "missing-key")
    if minimise is None:
        remedy = 'give a formula, as "max(rocker_omega)", or a table [optimise] in the recipe'
        raise DesignError("minimise", "found none", remedy, "missing-key")
    ranges = {key: _range(key, pair) for key, pair in vary.items()}
    source.check_keys({key: pair[0] for key, pair in ranges.items()})
    _check_limits(source, ranges)
    constraints = [subject_to] if isinstance(subject_to, str) else subject_to or ()
    objectives = [objective(text) for text in ([minimise] if isinstance(minimise, str) else minimise)]
    is_single = isinstance(minimise, str)
    if not is_single and not 2 <= len({one.text for one in objectives}) == len(objectives) <= MOST_OBJECTIVES:
        problem = f"found {len(objectives)} formulas: {', '.join(shown(one.text) for one in objectives)}"
        remedy = f"give one as a text, or 2 to {MOST_OBJECTIVES} different ones"
        raise DesignError("minimise", printable(problem, 1000), remedy, "conflict")
    conditions = [parsed_constraint(text) for text in constraints]
    trials = Trials(source, objectives, conditions, time.time() + time_limit)
    own = _own_values(source, ranges)
    boxes = _boxes(own, ranges)
    try:
        search(trials, boxes, own, starts, seed, run)
    except KeyboardInterrupt:
        trials.is_cut = True
    report_progress(1.0, "optimising")
    best = _best(trials)
    return _result(trials, best, ranges) if is_single else _front(trials, boxes)


def ranges_of(texts: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Ranges by key from texts such as `linkage.crank = 20:40`."""
    form = "KEY=LOW:HIGH (linkage.crank=20:40)"
    ranges: dict[str, tuple[float, float]] = {}
    for key, pair in texts_by_key("vary", texts, form).items():
        try:
            low, high = map(float, pair.split(":"))
            if not is_real(low) or not is_real(high):
                raise ValueError
        except ValueError:
            raise DesignError("vary", f"found {shown(f'{key}={pair}')}", f"give {form}", "wrong-type") from None
        ranges[key] = (low, high)
    return ranges


def _range(key: str, pair: Sequence[float]) -> tuple[float, float]:
    low, high = pair
    if not low < high:
        raise DesignError(key, f"found the range {low:g} to {high:g}", "give the smaller value first")
    return low, high


def _check_limits(source: VariedRecipe, ranges: Mapping[str, tuple[float, float]]) -> None:
    """DesignError for a range with values that a key never has, such as negative lengths."""
    unit, kind = UNITS.get(str(source.recipe.get("units")), MM), source.recipe.get("kind")
    if not isinstance(kind, str) or kind not in kind_names():
        return  # Refused when the recipe is read.
    for key, pair in ranges.items():
        declared = field_of(key, recipe_class(kind))
        about = declared.about if declared else {}
        low, high = (unit.in_mm(value, about.get("unit", "")) for value in pair)
        if low < about.get("gt", about.get("ge", -math.inf)) or high > about.get("lt", about.get("le", math.inf)):
            problem = f"found the range {pair[0]:g} to {pair[1]:g}"
            raise DesignError(key, problem, f"give limits that are {unit.text(marked(allowed(about)))}", "out-of-range")


def _boxes(own: Mapping[str, float], ranges: Mapping[str, tuple[float, float]]) -> list[Box]:
    """A box for each combination of whole numbers."""
    whole = {
        key: range(math.ceil(low), math.floor(high) + 1)
        for key, (low, high) in ranges.items()
        if isinstance(own[key], int)
    }
    count = math.prod(map(len, whole.values()))
    if not 0 < count <= MOST_COMBINATIONS:
        problem = f"found {count:,} combinations of whole numbers" if count else "found a range without a whole number"
        raise DesignError(next(iter(whole)), problem, f"give ranges with 1 to {MOST_COMBINATIONS:,}", "too-much-work")
    return [
        Box(
            {key: fixed.get(key, low) for key, (low, _) in ranges.items()},
            {key: fixed.get(key, high) for key, (_, high) in ranges.items()},
        )
        for numbers in itertools.product(*whole.values())
        for fixed in [dict(zip(whole, numbers))]
    ]


def _own_values(source: VariedRecipe, ranges: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """The recipe's values of the keys, within their ranges; DesignError for a key that is not of a number."""
    recipe = source.opened({})
    numbers = {number.key: number.value for number in shown_numbers(recipe)}
    own: dict[str, float] = {}
    for key, (low, high) in ranges.items():
        given: Any = source.recipe
        for part in key_parts(key):
            given = given[part] if isinstance(part, int) or part in given else {}
        # A key that is left out may have no value.
        value = numbers.get(key)
        if value is None and given == {}:
            value = _accepted(source, key, low, high)
        if value is None:
            problem = "is not a number" if given == {} else f"found {shown(given)}, which is not a number"
            remedy = f"vary keys of numbers; `geomkin sweep --set {key}=VALUE,VALUE` tries values that are not"
            raise DesignError(key, problem, remedy, "wrong-type")
        own[key] = value if isinstance(value, int) else float(min(max(value, low), high))
    return own


def _accepted(source: VariedRecipe, key: str, low: float, high: float) -> float | None:
    """The middle of the range of a key, or a whole number in it if only these are; None if it takes no numbers."""
    for value in ((low + high) / 2, math.ceil(low)):
        try:
            source.opened({key: value})
        except RecipeError as error:
            if any(problem.key == key and problem.id == "wrong-type" for problem in error.problems):
                continue
        return value
    return None


def _best(trials: Trials) -> TriedDesign:
    """The best design; DesignError if there is none, or it violates a constraint."""
    if not trials.designs:
        remedy = "give more time" if trials.is_cut else "give ranges in which the mechanism can be assembled"
        problem = f"none of {trials.count:,} designs works; the first was refused: {printable(trials.refusal, 300)}"
        if not trials.refusal:
            problem = "it ended before a first design was evaluated"
        raise DesignError("time_limit" if trials.is_cut else "vary", problem, remedy, "does-not-assemble")
    design = min(trials.designs, key=Target().rank)
    if design.violation > 0:
        _refuse(trials, design)
    return design


def _result(trials: Trials, design: TriedDesign, ranges: Mapping[str, tuple[float, float]]) -> OptimisedDesign:
    recipe = trials.recipe.opened(design.values)
    return OptimisedDesign(
        recipe=recipe,
        values=design.values,
        minimised=trials.objectives[0].text,
        objective=float(design.objectives[0]),
        constraints=tuple(
            one.check(f"constraint_{k}", *sides)
            for k, (one, sides) in enumerate(zip(trials.conditions, trials.sides(recipe)), 1)
        ),
        evaluations=trials.count,
        cut_short=trials.is_cut,
        at_ends=tuple(key for key, value in design.values.items() if _is_at_end(value, *ranges[key])),
    )


def _is_at_end(value: float, low: float, high: float) -> bool:
    step = 1 if isinstance(value, int) else AT_END * (high - low)
    return value - step < low or value + step > high


def _front(trials: Trials, boxes: Sequence[Box]) -> ParetoFront:
    designs = [
        FrontDesign(trials.recipe.opened(design.values), design.values, tuple(design.objectives.tolist()))
        for design in front_of(trials, boxes)
    ]
    return ParetoFront(tuple(one.text for one in trials.objectives), tuple(designs), trials.count, trials.is_cut)


def _refuse(trials: Trials, design: TriedDesign) -> NoReturn:
    """Name the constraints that the best design misses, the worst one first, and by how much."""
    sides = trials.sides(trials.recipe.opened(design.values))
    order = [k for k in np.argsort(-design.excesses) if design.excesses[k] > NO_VIOLATION]
    missed = " and ".join(f"{shown(trials.conditions[k].text)} by {sides[k][0] - sides[k][1]:.4g}" for k in order)
    values = ", ".join(f"{key} = {value:.6g}" for key, value in design.values.items())
    problem = f"none of {trials.count} designs meets all; the nearest ({values}) misses {missed}"
    raise DesignError("subject_to", printable(problem, 1000), "relax a constraint, or give wider ranges")
