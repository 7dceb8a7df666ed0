"""The search: random designs, gradient searches from the best of them, and the Pareto front of several objectives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import field
from functools import cached_property, partial
from glob import escape
from itertools import combinations
from math import comb
from pathlib import Path
from typing import Any

import numpy as np

from ..core.errors import harmless, printable
from ..core.fields import to_digits
from ..core.processes import Runner, by_this_process, report
from ..core.records import record
from ..export.summary import remove, write_whole
from ..export.tables import csv, plot_file
from ..export.text import number, text
from ..model.scene import Plot
from ..model.table import Column, Table
from ..page.page import rows_document
from ..page.sections import html_section, wide
from ..plane.vec import Real
from ..recipe.load import to_toml
from ..recipe.recipe import AbstractRecipe
from .designs import Target, Trials, TriedDesign

# Step of a difference quotient, as a share of a key's range.
DIFFERENCE = 1e-7
# Relative change of the objective and of the values at which a gradient search ends, and its most steps.
CONVERGED, MOST_STEPS = 1e-10, 200
# Distance from its limit at which a constraint is kept, as a share of its terms, so that rounding does not violate it.
MARGIN = 1e-9


class TimeOverError(Exception):
    """The time limit, from within a gradient search."""


@record(eq=False)
class Box:
    """Ranges of the keys that vary.

    Parameters
    ----------
    low, high : mapping of str to float
        By key; keys of whole numbers are fixed, with equal values.
    """

    low: Mapping[str, float]
    high: Mapping[str, float]

    @property
    def free(self) -> tuple[str, ...]:
        """Keys whose value varies."""
        return tuple(key for key in self.low if self.low[key] < self.high[key])

    def holds(self, values: Mapping[str, float]) -> bool:
        """Whether the values are within the ranges."""
        return all(low <= values[key] <= self.high[key] for key, low in self.low.items())

    def values(self, shares: Real) -> dict[str, float]:
        """Values by key at shares of the ranges of the free keys."""
        varied = {
            key: min(self.low[key] + float(share) * (self.high[key] - self.low[key]), self.high[key])
            for key, share in zip(self.free, shares)
        }
        return {key: varied.get(key, self.low[key]) for key in self.low}

    def shares(self, values: Mapping[str, float]) -> Real:
        """Shares of the ranges, of values by key."""
        return np.array([(values[key] - self.low[key]) / (self.high[key] - self.low[key]) for key in self.free])


def gradient_search(trials: Trials, box: Box, start: Real, target: Target, of_violation: bool = False) -> None:
    """Sequential quadratic programming from one design; the designs that it tries are added to `trials`.

    The largest of many values is minimised through one more variable that none of them exceeds, so that kinks are no
    obstacle. Gradients are difference quotients. Kraft, A software package for sequential quadratic programming, 1988,
    as NLopt has it. With `of_violation` the largest violation of a constraint is minimised instead of the objective.
    """
    import nlopt

    reference = None if trials.over() else trials.tried(box.values(start))
    if reference is None:
        return
    programme = _Programme(trials, box, len(start), target, of_violation, _rows(target, reference, of_violation))
    has_bound, values = programme.has_bound, programme.reference[0]
    solver = nlopt.opt(nlopt.LD_SLSQP, len(start) + has_bound)
    solver.set_min_objective(programme.objective)
    if rows := len(programme.reference[1]) + (len(values) if has_bound else 0):
        solver.add_inequality_mconstraint(programme.constraints, np.zeros(rows))
    solver.set_lower_bounds(np.append(np.zeros(len(start)), [-np.inf] * has_bound))
    solver.set_upper_bounds(np.append(np.ones(len(start)), [np.inf] * has_bound))
    solver.set_ftol_rel(CONVERGED)
    solver.set_xtol_rel(CONVERGED)
    solver.set_maxeval(MOST_STEPS)
    # At an optimum where many values are equal there may be no further step; the best design is known.
    with suppress(TimeOverError, nlopt.RoundoffLimited, nlopt.ForcedStop, nlopt.runtime_error):
        solver.optimize(np.append(start, [float(values.max()) / programme.scale] * has_bound))


@record(eq=False)
class _Programme:
    """Objective and constraints of a gradient search, as NLopt calls them; its unknowns are shares of a box.

    Parameters
    ----------
    count : int
        Number of shares; if the largest of several values is minimised, their bound is one more unknown.
    reference : tuple of arrays
        Rows of the objective and of the constraints at the start.
    """

    trials: Trials
    box: Box
    count: int
    target: Target
    of_violation: bool
    reference: tuple[Real, Real]

    @property
    def has_bound(self) -> bool:
        return len(self.reference[0]) > 1

    @cached_property
    def scale(self) -> float:
        return max(float(np.abs(self.reference[0]).max()), 1e-12)

    @cached_property
    def _results_by_shares(self) -> dict[bytes, tuple[Real, Real]]:
        return {}

    def results(self, shares: Real) -> tuple[Real, Real]:
        """Rows of the objective and of the constraints; far above all others where there is no design."""
        if self.trials.over():
            raise TimeOverError
        key, (objective_rows, excess_rows) = shares.tobytes(), self.reference
        if key not in self._results_by_shares:
            design = self.trials.tried(self.box.values(shares))
            if design is None:
                self._results_by_shares[key] = np.full(len(objective_rows), 1e3), np.ones(len(excess_rows))
            else:
                wanted, excess = _rows(self.target, design, self.of_violation)
                self._results_by_shares[key] = (
                    _resampled(wanted, len(objective_rows)) / self.scale,
                    _resampled(excess, len(excess_rows)) + MARGIN,
                )
        return self._results_by_shares[key]

    def slopes(self, shares: Real) -> tuple[Real, Real]:
        """Derivatives of both by the shares."""
        here, columns = self.results(shares), []
        for k in range(self.count):
            step = DIFFERENCE if shares[k] + DIFFERENCE <= 1 else -DIFFERENCE
            there = self.results(shares + step * np.eye(self.count)[k])
            columns.append([(b - a) / step for a, b in zip(here, there)])
        return np.stack([c[0] for c in columns], axis=1), np.stack([c[1] for c in columns], axis=1)

    def objective(self, x: Real, gradient: Real) -> float:
        if self.has_bound:
            if gradient.size:
                gradient[:] = np.append(np.zeros(self.count), 1.0)
            return float(x[self.count])
        if gradient.size:
            gradient[:] = self.slopes(x)[0][0]
        return float(self.results(x)[0][0])

    def constraints(self, values: Real, x: Real, gradient: Real) -> None:
        count = self.count
        wanted_rows, excess = self.results(x[:count])
        if self.has_bound:
            values[:] = np.concatenate([wanted_rows - x[count], excess])
        else:
            values[:] = excess
        if gradient.size:
            by_objective, by_excess = self.slopes(x[:count])
            if self.has_bound:
                gradient[:, :count] = np.concatenate([by_objective, by_excess])
                gradient[:, count] = np.where(np.arange(len(values)) < len(wanted_rows), -1.0, 0.0)
            else:
                gradient[:] = by_excess


def _rows(target: Target, design: TriedDesign, of_violation: bool) -> tuple[Real, Real]:
    """The rows of which the largest is minimised, and those that have to be at most 0."""
    excess = np.concatenate([*design.excess_rows, np.zeros(0)])
    return (excess, np.zeros(0)) if of_violation else (target.rows(design), excess)


def _resampled(rows: Real, count: int) -> Real:
    """The rows, interpolated if a design has another number of them."""
    if len(rows) == count:
        return rows
    resampled: Real = np.interp(np.linspace(0, 1, count), np.linspace(0, 1, len(rows)), rows)
    return resampled


# Random designs per key, the most of them if few work, and the least distance of the designs from which gradient
# searches start, as a share of the ranges.
RANDOM_DESIGNS, RARE, APART = 10, 500, 0.1
# Most points of the front. With more each point says less, and takes as long.
MOST_POINTS = 21

# Adds designs to trials.
Job = Callable[[Trials], None]


def search(trials: Trials, boxes: Sequence[Box], own: Mapping[str, float], starts: int, seed: int, run: Runner) -> None:
    """Search the least value of each objective; if there are several, then points of the front between them."""
    count = len(trials.objectives)
    steps = len(boxes) * (1 + count * starts) + (MOST_POINTS if count > 1 else 0)
    done = 0

    def tried_by(jobs: Sequence[Job], run: Runner = run) -> list[Trials]:
        """The trials of each job, which are added to all."""
        nonlocal done
        parts: dict[int, Trials] = {}
        try:
            for index, part in run(partial(_trials_of, trials.without_designs()), jobs):
                # A worker that was killed has no designs.
                parts[index] = part or trials.without_designs()
                done += 1
                report(min(done / steps, 1 - 1 / steps), "optimising")
                if parts[index].is_interrupted:
                    raise KeyboardInterrupt
        finally:
            for index in sorted(parts):
                trials.add(parts[index])
        return [parts[index] for index in range(len(jobs))]

    explorations = [
        partial(explore, box=box, own=box.values(box.shares(own)), starts=starts, seed=seed) for box in boxes
    ]
    # The first design that works reports ids that do not exist, and scales the constraints of all others.
    explored: list[Trials] = []
    while len(explored) < len(boxes) and trials.scales is None:
        explored += tried_by([explorations[len(explored)]], by_this_process)
    explored += tried_by(explorations[len(explored) :])
    found = [list(part.designs) if box.free else [] for box, part in zip(boxes, explored)]

    def descend(searches: Sequence[tuple[int, Target, Real]], of_violation: bool = False) -> None:
        """Gradient searches: (number of a box, target, start)."""
        jobs = [
            partial(gradient_search, box=boxes[k], start=start, target=target, of_violation=of_violation)
            for k, target, start in searches
        ]
        for (k, _, _), part in zip(searches, tried_by(jobs)):
            found[k] += part.designs

    def nearest(k: int, target: Target) -> TriedDesign:
        return min(found[k], key=target.rank)

    single = [Target((k,)) for k in range(count)]
    descend(
        [
            (k, target, start)
            for target in single
            for k, box in enumerate(boxes)
            for start in starts_apart(box, found[k], target, starts)
        ]
    )
    unmet = [k for k, designs in enumerate(found) if designs and nearest(k, single[0]).violation > 0]
    descend([(k, single[0], boxes[k].shares(nearest(k, single[0]).values)) for k in unmet], of_violation=True)
    met = [k for k in unmet if nearest(k, single[0]).violation == 0]
    descend([(k, target, boxes[k].shares(nearest(k, target).values)) for target in single for k in met])
    if count > 1 and any(design.violation == 0 for design in trials.designs):
        best = [(target, min(trials.designs, key=target.rank).values) for target in targets(trials.designs, count)]
        places = [next(k for k, box in enumerate(boxes) if box.holds(values)) for _, values in best]
        descend([(k, one[0], boxes[k].shares(one[1])) for k, one in zip(places, best) if boxes[k].free])


def _trials_of(trials: Trials, job: Job) -> Trials:
    """The designs of one job; if it is interrupted, those until then."""
    trials = trials.without_designs()
    try:
        job(trials)
    except KeyboardInterrupt:
        trials.is_interrupted = True
    return trials


def explore(trials: Trials, box: Box, own: Mapping[str, float], starts: int, seed: int) -> None:
    """Try the recipe's own values and random designs, until some of them work."""
    free = len(box.free)
    rng = np.random.default_rng(seed)
    random = list(rng.random((RANDOM_DESIGNS * free if starts > 1 else 0, free)))
    for values in (own, *map(box.values, random)):
        if not trials.over():
            trials.tried(values)
    # Designs that work may be rare.
    for shares in rng.random((RARE * free, free)):
        if trials.over() or len(trials.designs) >= starts:
            break
        trials.tried(box.values(shares))


def starts_apart(box: Box, designs: Sequence[TriedDesign], target: Target, most: int) -> list[Real]:
    """Shares of the best designs that lie apart."""
    chosen: list[Real] = []
    for design in sorted(designs, key=target.rank):
        shares = box.shares(design.values)
        if len(chosen) < most and all(np.abs(shares - other).max() > APART for other in chosen):
            chosen.append(shares)
    return chosen


def targets(designs: Sequence[TriedDesign], count: int) -> list[Target]:
    """Targets whose optima are spread over the front.

    Each objective is scaled to 0 at its least value and to 1 at its greatest one among the optima of single objectives.
    From evenly spaced points of the plane through these optima, the largest objective is minimised: the front is met
    in the direction in which all objectives improve equally. Pascoletti and Serafini, Scalarizing vector optimization
    problems, Journal of Optimization Theory and Applications 42, 1984. With the plane of Das and Dennis, 1998.
    """
    optima = np.array([min(designs, key=Target((k,)).rank).objectives for k in range(count)])
    least, scales = optima.min(axis=0), np.ptp(optima, axis=0)
    scales = np.where(scales > 0, scales, 1.0)
    return [Target(tuple(range(count)), least + shares * scales, scales) for shares in even_shares(count)]


def even_shares(count: int) -> Iterator[Real]:
    """Evenly spaced rows of `count` numbers from 0 to 1 whose sum is 1, at most `MOST_POINTS`."""
    divisions = max(n for n in range(1, MOST_POINTS) if comb(n + count - 1, count - 1) <= MOST_POINTS)
    for bars in combinations(range(divisions + count - 1), count - 1):
        yield (np.diff([-1, *bars, divisions + count - 1]) - 1) / divisions


# Most objectives. With more of them each point of the front says less.
MOST_OBJECTIVES = 4
# Digits of the objectives, as shares of their ranges, in which designs that are equal count as one.
DIGITS = 6


@record(eq=False)
class FrontDesign:
    """A design of a Pareto front.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe with the values of the design.
    values : mapping of str to float or int
        By key.
    objectives : tuple of float
        The value of each objective.
    """

    recipe: AbstractRecipe
    values: Mapping[str, float]
    objectives: tuple[float, ...]


@record(eq=False)
class ParetoFront:
    """The designs that an optimisation with several objectives found.

    Parameters
    ----------
    minimised : tuple of str
        The formulas of the objectives.
    designs : tuple of FrontDesign
        By rising first objective; none is better than another in all objectives.
    evaluations : int
        Number of designs that were tried.
    cut_short : bool
        Whether the time limit or an interruption ended the search.
    files : mapping of Path to int
        Written files with their size in bytes.
    """

    minimised: tuple[str, ...]
    designs: tuple[FrontDesign, ...]
    evaluations: int
    cut_short: bool = False
    files: Mapping[Path, int] = field(default_factory=dict)

    @property
    def table(self) -> Table:
        """A row for each design: its number from 1, its objectives and the values of its keys."""
        numbers = Column("design", "", "number of the design", np.arange(1, len(self.designs) + 1))
        values = {key: np.array([design.values[key] for design in self.designs]) for key in self.designs[0].values}
        keys = (Column(key, "", "value under this key", row) for key, row in values.items())
        return Table((numbers, *self._objectives, *keys))

    @property
    def _objectives(self) -> Iterator[Column]:
        results = np.array([design.objectives for design in self.designs]).T
        for objective, row in zip(self.minimised, results):
            yield Column(objective, "", "objective", row)

    @property
    def lines(self) -> list[str]:
        """The table as lines of text."""
        heads = [printable(column.id) for column in self.table.columns]
        rows = zip(*(column.values.tolist() for column in self.table.columns))
        lines = ["  ".join(f"{value:{max(len(head), 8)}.6g}" for value, head in zip(row, heads)) for row in rows]
        return ["  ".join(f"{head:>8}" for head in heads), *lines]

    def picture(self) -> bytes:
        """The other objectives over the first one, as an SVG file."""
        return plot_file(Table(tuple(self._objectives)), Plot("Pareto front", self.minimised[1:]), dots=True)


def front_of(trials: Trials, boxes: Sequence[Box]) -> list[TriedDesign]:
    """The front of all designs that were tried, thinned to one for each target unless all keys are whole numbers."""
    designs = [design for design in trials.designs if design.violation == 0]
    results = np.array([design.objectives for design in designs])
    size = np.ptp(results, axis=0)
    front = [designs[k] for k in undominated(np.round(results / np.where(size > 0, size, 1.0), DIGITS))]
    if any(box.free for box in boxes):
        chosen = [min(front, key=target.rank) for target in targets(trials.designs, len(trials.objectives))]
        front = [design for design in front if any(design is one for one in chosen)]
    return sorted(front, key=lambda design: tuple(design.objectives))


def undominated(results: Real) -> list[int]:
    """Numbers of the rows (n, objectives) to which no other row is equal or better in all columns, but one of twins."""
    left = np.lexsort(results.T[::-1])
    front = []
    while len(left):
        first, left = left[0], left[1:]
        front.append(int(first))
        left = left[(results[left] < results[first]).any(axis=1)]
    return front


# A click on a design, or Enter, opens its recipe and closes the others.
CHOOSE = """(row) => {
  const designs = [...document.querySelectorAll("#designs details")];
  designs.forEach((design, k) => { design.open = k === row; });
  designs[row].scrollIntoView({ block: "nearest" });
}"""


def write_front(front: ParetoFront, folder: Path, name: str, copies: Mapping[str, bytes]) -> dict[Path, int]:
    """Write the table, the picture, the page, a recipe for each design, and copies of the files that they name.

    Recipes of an earlier, longer front are removed.
    """
    contents = {
        f"{name}.front.csv": csv(front.table),
        f"{name}.front.svg": front.picture(),
        f"{name}.front.html": front_page(name, front),
    }
    for k, design in enumerate(front.designs, 1):
        contents[f"{name}.front-{k}.toml"] = to_toml(design.recipe).encode()
    contents |= copies
    write_whole(folder, contents)
    for path in folder.glob(f"{escape(name)}.front-*.toml"):
        if path.name not in contents:
            remove(path)
    return {folder / file: len(content) for file, content in contents.items()}


def front_page(name: str, front: ParetoFront) -> bytes:
    """The page of a front. name: of the recipe."""
    numbers, *columns = front.table.columns
    objectives, keys = columns[: len(front.minimised)], columns[len(front.minimised) :]
    data = {
        "name": harmless(name),
        "frames": len(front.designs),
        "spots": True,
        "columns": [_column(column) for column in columns],
        "plots": [{"title": harmless(column.id), "columns": [k]} for k, column in enumerate(columns[1:], 1)],
    }
    about = (
        f"<p>{len(front.designs)} designs, none of which is better than another in all of {_names(objectives)}. Click "
        "a design in a plot, or choose it with the arrow keys and Enter: its recipe opens below.</p>"
    )
    heads = "".join(f'<th scope="col">{text(column.id)}</th>' for column in (numbers, *columns))
    cells = [[f"<td>{number(float(value))}</td>" for value in column.values] for column in columns]
    rows = "".join(f'<tr><th scope="row">{k}</th>{"".join(row)}</tr>' for k, row in enumerate(zip(*cells), 1))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    recipes = "".join(_design(k, design, keys) for k, design in enumerate(front.designs, 1))
    body = (
        '<section id="plots" class="values" aria-label="Plots"></section>\n'
        f"{html_section('designs', 'Recipes', recipes)}{html_section('table', 'All designs', wide('Designs', table))}\n"
    )
    return rows_document(f"{name}: Pareto front", about, body, data, CHOOSE)


def _names(columns: Sequence[Column]) -> str:
    return " and ".join(f"<code>{text(column.id)}</code>" for column in columns)


def _column(column: Column) -> dict[str, Any]:
    row = [to_digits(float(value), 6) for value in column.values]
    return {"name": harmless(column.id), "unit": "", "meaning": column.meaning, "row": row}


def _design(k: int, design: FrontDesign, keys: Sequence[Column]) -> str:
    values = ", ".join(f"{text(key.id)} = {number(float(key.values[k - 1]))}" for key in keys)
    recipe = "\n".join(map(text, to_toml(design.recipe).splitlines()))
    return f'<details><summary>Design {k}: {values}</summary><pre tabindex="0"><code>{recipe}</code></pre></details>\n'
