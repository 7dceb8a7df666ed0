"""A family of three ways to a sum, and a chart of them that nothing was measured for."""

import numpy as np

import geomkin as gk


def _adds(problem, terms):
    return lambda: float(sum(problem[: int(terms) if terms == terms else None]))


HALVES = 0.5 ** np.arange(1, 60)
METHODS = (
    gk.tradeoff.Method("all <terms>", "Adds all of them.", _adds, rationale="it errs least."),
    gk.tradeoff.Method("some", "Adds the first.", _adds, "terms", (1.0, 2.0, 5.0, 10.0)),
    gk.tradeoff.Method("none", "Finds nothing.", lambda problem, _: lambda: float("nan"), slow=True),
)
FAMILY = gk.tradeoff.MethodFamily(
    name="toy-sum",
    title="Sum of halves & quarters",
    about="The sum of the powers of one half.",
    per="sum",
    unit="mm",
    reference="the sum of the endless series, 1",
    floor=1e-15,
    problem=lambda: HALVES,
    count=lambda problem, found: 1,
    error=lambda problem, found: np.array([abs(found - 1), 0.0]),
    methods=METHODS,
)


def point(method, setting, error, seconds, missed=0.0):
    return gk.tradeoff.Measurement("toy-sum", method, setting, error, error / 2, missed, seconds, 1, 10, 3, 0.05)


POINTS = (
    point("all <terms>", np.nan, 0.0, 4e-6),
    point("some", 1.0, 0.5, 1e-6),
    point("some", 2.0, 0.25, 2e-6),
    point("some", 5.0, 0.03, 5e-6),
    point("some", 10.0, 1e-3, 3e-6),
    point("none", np.nan, np.nan, 1e-9, 1.0),
    # Fast and right where it finds anything.
    point("none", np.nan, 1e-7, 5e-7, 0.25),
)
CHART = gk.tradeoff.Chart((gk.tradeoff.FamilyChart(FAMILY, POINTS),), True, {"geomkin": "0"}, "a <processor>")
