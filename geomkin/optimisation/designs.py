"""Designs that a search tries: a recipe with values for its keys, and its objective and constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..build import errors_named_by_key
from ..core.errors import DesignError, GeomkinError, printable, shown
from ..core.progress import shown as progress_shown
from ..core.records import record
from ..plane.vec import Real
from ..recipe.messages import nearest
from ..recipe.recipe import AbstractRecipe
from ..sweeps.row import Task
from .formulas import Condition, Formula

# Violation of a constraint that counts as none, as a share of its terms.
NO_VIOLATION = 1e-8


@record(eq=False)
class TriedDesign:
    """One design.

    Parameters
    ----------
    values : mapping of str to float
        By key.
    objectives : array, shape (k,)
        Values of the objectives.
    excesses : array, shape (m,)
        By how much each constraint is violated, as a share of its terms; 0 or less if it is met.
    objective_rows, excess_rows : tuple of array
        The values of which these are the largest; for the gradient search.
    """

    values: Mapping[str, float]
    objectives: Real
    excesses: Real
    objective_rows: tuple[Real, ...]
    excess_rows: tuple[Real, ...]

    @property
    def violation(self) -> float:
        """The largest violation; 0 if all constraints are met."""
        largest = float(self.excesses.max(initial=0.0))
        return largest if largest > NO_VIOLATION else 0.0


class Trials:
    """All designs that a search has tried.

    Parameters
    ----------
    task : Task
        The recipe that is varied.
    objectives, conditions : sequence
        What is minimised, and the constraints.
    """

    def __init__(self, task: Task, objectives: Sequence[Formula], conditions: Sequence[Condition]):
        self.task, self.objectives, self.conditions = task, objectives, conditions
        self.designs: list[TriedDesign] = []
        self.count = 0
        self.refusal = ""
        self._scales: list[float] = []

    def tried(self, values: Mapping[str, float]) -> TriedDesign | None:
        """The design with these values; None if there is none, or a result is undefined for it."""
        self.count += 1
        try:
            # A search reports its own progress, not that of each design.
            with progress_shown(lambda *_: None):
                recipe = self.task.opened(values)
                with errors_named_by_key(self.task.file, recipe):
                    _ = recipe.table
        except GeomkinError as error:
            self.refusal = self.refusal or str(error).split("\n")[0]
            return None
        objective_rows = tuple(formula.rows(_Results("minimise", recipe), "max") for formula in self.objectives)
        excess_rows = [one.excess(_Results("subject_to", recipe)) for one in self.conditions]
        if not all(np.isfinite(rows).all() for rows in (*objective_rows, *excess_rows)):
            self.refusal = self.refusal or "a result that the formulas name is undefined at some positions"
            return None
        if not self._scales:
            sides = [one.sides(_Results("subject_to", recipe)) for one in self.conditions]
            self._scales = [max(abs(least), abs(most), 1e-12) for least, most in sides]
        excess_rows = [rows / scale for rows, scale in zip(excess_rows, self._scales)]
        design = TriedDesign(
            dict(values),
            np.array([rows.max() for rows in objective_rows]),
            np.array([rows.max() for rows in excess_rows]),
            objective_rows,
            tuple(excess_rows),
        )
        self.designs.append(design)
        return design

    def sides(self, values: Mapping[str, float]) -> list[tuple[float, float]]:
        """The values of both sides of each constraint."""
        recipe = self.task.opened(values)
        return [one.sides(_Results("subject_to", recipe)) for one in self.conditions]


class _Results:
    """Values of a recipe's columns and checks by id, for formulas."""

    def __init__(self, field: str, recipe: AbstractRecipe):
        self.field, self.recipe = field, recipe

    def __call__(self, name: str) -> Any:
        columns = [c for c in self.recipe.table.columns if c.values.dtype.kind in "fiub"]
        for column in columns:
            if name in (column.id, column.header):
                return column.values
        checks = {check.id: check.value for check in self.recipe.checks}
        if name in checks:
            return checks[name]
        known = [*(column.id for column in columns), *checks]
        raise DesignError(
            self.field,
            f"found {shown(name)}",
            f"{nearest(name, known)}give a column or a check: {printable(', '.join(known), 2000)}",
            "unknown-key",
        )
