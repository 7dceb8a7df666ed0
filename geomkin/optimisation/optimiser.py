"""Optimisation of a recipe: the values of some of its keys that make an objective least within constraints."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Annotated, Any, NoReturn

import numpy as np

from ..build import Readable
from ..core.arguments import ArgumentType, PositiveFloat, checked, is_real, whole_between
from ..core.errors import DesignError, printable, shown
from ..core.progress import Watch
from ..core.records import record
from ..export.files import write_whole
from ..model.check import Check
from ..plane.vec import Real
from ..recipe.load import to_toml
from ..recipe.recipe import AbstractRecipe
from ..sweeps.row import Task
from ..sweeps.sweep import _check_keys, _task
from .designs import Trials, TriedDesign
from .formulas import condition, objective
from .search import Box, Goal, minimise

# Largest number of combinations of whole numbers, each of which is searched.
MOST_COMBINATIONS = 10_000
# Number of points of a front for two objectives, and most objectives.
FRONT, MOST_OBJECTIVES = 11, 4
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
        "a table of keys, each with its least and greatest value",
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
    objectives : mapping of str to float
        Value of each objective, by its text.
    constraints : tuple of Check
        Each constraint with its value and limit.
    evaluations : int
        Number of designs that were tried.
    cut_short : bool
        Whether the time limit or an interruption ended the search.
    front : tuple of OptimisedDesign
        For several objectives, the Pareto front: designs of which none is better than another in all of them. This
        design is the one nearest to the best of each. Empty for one objective.
    files : mapping of Path to int
        Written files with their size in bytes.
    """

    recipe: AbstractRecipe
    values: Mapping[str, float]
    objectives: Mapping[str, float]
    constraints: tuple[Check, ...]
    evaluations: int
    cut_short: bool = False
    front: tuple[OptimisedDesign, ...] = ()
    files: Mapping[Path, int] = field(default_factory=dict)


@checked
def optimise(
    recipe: AbstractRecipe | Readable,
    vary: Ranges,
    minimise: Texts,
    subject_to: Texts = (),
    starts: Annotated[int, whole_between(1, 1000)] = 6,
    seed: Annotated[int, whole_between(0, 2**32 - 1)] = 0,
    time_limit: PositiveFloat = 60,
    out: str | Path | None = None,
) -> OptimisedDesign:
    """Find the values of a recipe's keys that make a result least within constraints.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or anything that `gk.load` reads.
    vary : mapping of str to (low, high)
        Dotted keys of numbers, such as "linkage.crank", with their ranges in the unit of the key. Keys of whole
        numbers, such as "gear.teeth", take every value of their range.
    minimise : str or sequence of str
        The objective: a formula of ids of columns and checks with `min`, `max`, `mean`, `range` and `rms`, such as
        "max(rocker_omega)", or "-min(transmission_angle)" for a maximum. "rms(distance(coupler_point, [[10, 20],
        [15, 22]]))" measures points from the path of a traced point, mm. Several formulas give a Pareto front.
    subject_to : str or sequence of str
        Constraints, such as "min(transmission_angle) >= 40".
    starts : int
        Number of gradient searches for each objective, 1 to 1000. With 1 the only one starts from the recipe's own
        values.
    seed : int
        Seed of the random designs.
    time_limit : float
        Longest time, s. When it is over, or at Ctrl-C, the best design so far is returned.
    out : str or Path, optional
        Folder for `<name>/<name>.optimum.toml`. By default nothing is written.

    Returns
    -------
    OptimisedDesign
        The best design.

    Raises
    ------
    RecipeError, FileError
        As for `gk.load`.
    DesignError
        If a key, range or formula is wrong, no design works, or none meets the constraints; the message then names
        the constraint that is missed and by how much.

    Notes
    -----
    Gradient searches (sequential quadratic programming) start from the best of random designs and need the package
    nlopt. Their gradients are difference quotients. A global optimum is likely, and not proved.

    Examples
    --------
    >>> import geomkin as gk
    >>> best = gk.optimise(
    ...     {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}},
    ...     vary={"linkage.coupler": (60, 120), "linkage.rocker": (60, 120)},
    ...     minimise="-min(transmission_angle)",
    ...     starts=1,
    ... )
    >>> round(-best.objectives["-min(transmission_angle)"], 2)
    56.6
    """
    task, name = _task(recipe, ())
    ranges = {key: _range(key, pair) for key, pair in vary.items()}
    if not ranges:
        raise DesignError(
            "vary", "found none", 'give a key and its range, as {"linkage.crank": (20, 40)}', "missing-key"
        )
    _check_keys(task, {key: (pair[0],) for key, pair in ranges.items()})
    objectives = [objective(text) for text in _texts(minimise)]
    if not objectives:
        raise DesignError("minimise", "found none", "give a formula such as max(rocker_omega)", "missing-key")
    trials = Trials(task, objectives, [condition(text) for text in _texts(subject_to)])
    watch = Watch(time_limit, "optimising")
    best: list[TriedDesign] = []
    is_interrupted = False
    try:
        for design in _best_designs(trials, ranges, starts, seed, watch):
            best.append(design)
    except KeyboardInterrupt:
        is_interrupted = True
    watch.report(1.0)
    found = _result(trials, best, watch.cut or is_interrupted)
    if out is None:
        return found
    folder, content = Path(out) / name, to_toml(found.recipe).encode()
    write_whole(folder, {f"{name}{ENDING}": content})
    return replace(found, files={folder / f"{name}{ENDING}": len(content)})


def _texts(texts: str | Sequence[str]) -> list[str]:
    return [texts] if isinstance(texts, str) else list(texts)


def _range(key: str, pair: Sequence[float]) -> tuple[float, float]:
    low, high = pair
    if not low < high:
        raise DesignError(key, f"found {low:g} to {high:g}", "give a range whose second value is the greater one")
    return low, high


def _best_designs(
    trials: Trials, ranges: Mapping[str, tuple[float, float]], starts: int, seed: int, watch: Watch
) -> Iterator[TriedDesign]:
    """The best design for each goal: each objective alone, then their weighted maxima."""
    boxes, own = _boxes(trials.task, ranges)
    known: list[list[TriedDesign]] = [[] for _ in boxes]
    count = len(trials.objectives)
    weights = _weights(count)
    done, total = 0, len(boxes) * (count + len(weights))

    def best(goal: Goal) -> TriedDesign | None:
        nonlocal done
        for k, box in enumerate(boxes):
            known[k] = minimise(trials, goal, box, known[k], box.values(box.shares(own)), starts, seed, watch)
            done += 1
            watch.report(done / total)
        return min((design for designs in known for design in designs[:1]), key=goal.rank, default=None)

    alone = [found for k in range(count) if (found := best(Goal((k,), (0.0,), (1.0,)))) is not None]
    yield from alone
    if weights and len(alone) == count:
        values = np.array([design.objectives for design in alone])
        least, spans = values.min(axis=0), np.maximum(np.ptp(values, axis=0), 1e-12)
        for weight in weights:
            goal = Goal(tuple(range(count)), tuple(least.tolist()), tuple((spans / weight).tolist()))
            if (found := best(goal)) is not None:
                yield found


def _boxes(task: Task, ranges: Mapping[str, tuple[float, float]]) -> tuple[list[Box], dict[str, float]]:
    """A box for each combination of whole numbers, and the recipe's own values, within the ranges."""
    recipe = task.opened({})
    own = {key: _own_value(recipe, task, key) for key in ranges}
    whole = {
        key: range(math.ceil(low), math.floor(high) + 1)
        for key, (low, high) in ranges.items()
        if isinstance(own[key], int)
    }
    count = math.prod(map(len, whole.values()))
    if not 0 < count <= MOST_COMBINATIONS:
        problem = f"found {count:,} combinations of whole numbers" if count else "found a range without a whole number"
        raise DesignError(next(iter(whole)), problem, f"give ranges with 1 to {MOST_COMBINATIONS:,}", "too-much-work")
    boxes = [
        Box(
            {key: fixed.get(key, low) for key, (low, _) in ranges.items()},
            {key: fixed.get(key, high) for key, (_, high) in ranges.items()},
        )
        for numbers in itertools.product(*whole.values())
        for fixed in [dict(zip(whole, numbers))]
    ]
    return boxes, {key: float(np.clip(own[key], *pair)) for key, pair in ranges.items()}


def _own_value(recipe: AbstractRecipe, task: Task, key: str) -> float:
    """The recipe's value of a key; DesignError if it is not a number."""
    value: Any = recipe
    for part in re.split(r"\.|(?=\[)", key):
        if part.startswith("["):
            value = [value.real, value.imag] if isinstance(value, complex) else value
            value = value[int(part[1:-1])]
        else:
            value = getattr(value, part, None)
    # A key that may be left out has no value of its own.
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise DesignError(key, f"found {shown(value)}, which is not a number", "give a key of a number", "wrong-type")
    return value


def _weights(count: int) -> list[Real]:
    """Weights of several objectives, each above 0, with the sum 1; none for one objective."""
    if count == 1:
        return []
    if count > MOST_OBJECTIVES:
        raise DesignError("minimise", f"found {count} objectives", f"give at most {MOST_OBJECTIVES}", "too-much-work")
    parts = FRONT - 1 if count == 2 else count + 3
    shares = itertools.product(range(1, parts), repeat=count)
    return [np.array(one) / parts for one in shares if sum(one) == parts]


def _result(trials: Trials, best: Sequence[TriedDesign], cut_short: bool) -> OptimisedDesign:
    if not best:
        # Cut short within the first search, or no design at all.
        best = sorted(trials.designs, key=Goal((0,), (0.0,), (1.0,)).rank)[:1]
    if not best:
        remedy = "give more time" if cut_short else "give ranges in which the mechanism can be assembled"
        problem = f"none of {trials.count} designs works, the first for this: {printable(trials.refusal, 300)}"
        raise DesignError("time_limit" if cut_short else "vary", problem, remedy, "does-not-assemble")
    good = [design for design in best if design.violation == 0]
    if not good:
        _refuse(trials, min(best, key=lambda design: design.violation))
    if len(trials.objectives) == 1:
        return _design(trials, good[0], cut_short)
    values = np.array([design.objectives for design in good])
    front = [
        k
        for k, row in enumerate(values)
        if not any(np.all(other <= row) and (np.any(other < row) or j < k) for j, other in enumerate(values) if j != k)
    ]
    front.sort(key=lambda k: values[k].tolist())
    span = np.maximum(np.ptp(values[front], axis=0), 1e-300)
    nearest = min(front, key=lambda k: float(np.max((values[k] - values[front].min(axis=0)) / span)))
    designs = tuple(_design(trials, good[k], cut_short) for k in front)
    return replace(designs[front.index(nearest)], front=designs)


def _refuse(trials: Trials, design: TriedDesign) -> NoReturn:
    """Name the constraint that the best design misses most, and by how much."""
    worst = int(np.argmax(design.excesses))
    least, most = trials.sides(design.values)[worst]
    text = trials.conditions[worst].text
    values = ", ".join(f"{key} = {value:.6g}" for key, value in design.values.items())
    problem = (
        f"none of {trials.count} designs meets all; the nearest ({values}) misses {shown(text)} by {least - most:.4g}"
    )
    raise DesignError("subject_to", printable(problem, 1000), "relax this constraint, or give wider ranges")


def _design(trials: Trials, design: TriedDesign, cut_short: bool) -> OptimisedDesign:
    constraints = tuple(
        one.check(f"constraint_{k}", *sides)
        for k, (one, sides) in enumerate(zip(trials.conditions, trials.sides(design.values)), 1)
    )
    return OptimisedDesign(
        recipe=trials.task.opened(design.values),
        values=design.values,
        objectives={one.text: float(value) for one, value in zip(trials.objectives, design.objectives)},
        constraints=constraints,
        evaluations=trials.count,
        cut_short=cut_short,
    )
