"""Counterweights on bodies that turn on fixed pivots, for shaking force, shaking moment or an even driver effort."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from ...core.arguments import between, checked
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, SMALLEST, Size
from ...core.records import record
from ...model.material import Mass
from ...plane.vec import Complex, Mask, Real, root_mean_square
from ..linkage import Linkage
from ..motion import Motion
from .inverse import AboutPoint, ForceAnalysis, forces
from .loads import Loads
from .wrenches import NEWTON, known_body

BalanceObjective = Literal["shaking_force", "shaking_moment", "driver"]
BalanceMeasure = Literal["root_mean_square", "maximum"]
# Effect of a counterweight, relative to its own inertia force and weight, that counts as rounding.
NO_EFFECT = 1e-9
# Share of the effect that would cancel the objective below which a body needs no counterweight.
NEGLIGIBLE = 1e-7
# Starts of the search if the problem is not convex; relative change at which each ends, and its most steps.
STARTS, CONVERGED, MOST_STEPS = 6, 1e-13, 1000


@record(eq=False)
class Balance:
    """Counterweights and the forces without and with them, as returned by `balance`.

    Parameters
    ----------
    objective : {"shaking_force", "shaking_moment", "driver"}
        The quantity that was minimised.
    counterweights : dict of str to Mass
        Body to the point mass to add to it, in the body's frame; of mass 0 if the body needs none.
    before, after : ForceAnalysis
        Forces without and with the counterweights; `after.loads` has the masses with them.
    """

    objective: BalanceObjective
    counterweights: dict[str, Mass]
    before: ForceAnalysis
    after: ForceAnalysis

    @property
    def rms_before(self) -> float:
        """Root mean square of the objective over the frames without counterweights, N or N mm."""
        return size_of_objective(self.before, self.objective, "root_mean_square")

    @property
    def rms_after(self) -> float:
        """Root mean square of the objective over the frames with the counterweights, N or N mm."""
        return size_of_objective(self.after, self.objective, "root_mean_square")

    @property
    def largest_before(self) -> float:
        """Largest size of the objective at a frame without counterweights, N or N mm."""
        return size_of_objective(self.before, self.objective, "maximum")

    @property
    def largest_after(self) -> float:
        """Largest size of the objective at a frame with the counterweights, N or N mm."""
        return size_of_objective(self.after, self.objective, "maximum")


@checked
def balance(
    motion: Motion,
    loads: Loads,
    bodies: Sequence[str],
    objective: BalanceObjective = "shaking_force",
    *,
    max_mass: Annotated[float, between(SMALLEST, FARTHEST, "kg")],
    max_radius: Size,
    about: AboutPoint = None,
    measure: BalanceMeasure = "root_mean_square",
) -> Balance:
    """The counterweights that minimise shaking force, shaking moment or the variation of the driver's effort.

    Parameters
    ----------
    motion : Motion
        The motion of one linkage with its speed; every frame counts equally.
    loads : Loads
        Masses of the bodies, and all other loads.
    bodies : sequence of str
        Bodies that carry one counterweight each; they turn on pivots of the fixed body.
    objective : {"shaking_force", "shaking_moment", "driver"}, optional
        Quantity that is minimised. For "driver" it is the deviation of the driver's torque or force from its mean.
    max_mass : float
        Largest mass of each counterweight, kg.
    max_radius : float
        Largest distance of each from the pivot of its body, mm.
    about : str or complex, optional
        Point of the shaking moment, as for `forces`.
    measure : {"root_mean_square", "maximum"}, optional
        Whether the root mean square over the frames is minimised, or the largest size at a frame.

    Returns
    -------
    Balance
        The counterweights, and the forces without and with them.

    Raises
    ------
    DesignError
        If a body turns on no fixed pivot, counterweights have no effect on the objective, or as for `forces`. For
        "driver" also if there is dry friction.

    See Also
    --------
    forces, masses

    Notes
    -----
    A counterweight is a point mass m at a distance r from its pivot. All objectives are linear in its first moment,
    m r and a direction, and its moment of inertia, m r2. The shaking force depends on the first moments alone: a
    convex problem, and the counterweights lie at the largest radius, where they are lightest. The other two are not
    convex, since a moment of inertia needs a mass off its pivot: the best of many local searches is returned. A global
    optimum is likely, and not proved.

    A four-bar whose crank and rocker have counterweights has no shaking force at all if the bounds allow it. The
    shaking moment, the driver's torque and forces in pins may become larger.

    References
    ----------
    Berkof and Lowen, A new method for completely force balancing simple linkages, Journal of Engineering for Industry
    91, 1969.

    Examples
    --------
    >>> import geomkin as gk
    >>> turn = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 360, endpoint=False), speed=20.0)
    >>> loads = gk.Loads(masses={"coupler": gk.Mass(0.3, centre=45, inertia=200)})
    >>> best = gk.balance(turn, loads, ["crank", "rocker"], max_mass=1.0, max_radius=40.0)
    >>> weight = best.counterweights["crank"]
    >>> round(weight.mass, 4), round(weight.centre.real, 4)
    (0.1125, -40.0)
    >>> best.rms_after < 1e-9 * best.rms_before
    True
    """
    linkage, bodies = motion.linkage, tuple(bodies)
    if linkage.is_batch:
        raise DesignError("motion", "found many linkages at once", "give one", "wrong-type")
    if objective == "driver" and any(friction.coefficient for friction in loads.friction):
        problem = "found dry friction, with which the driver's effort is not linear in the masses"
        raise DesignError("loads.friction", problem, "give viscous friction only, or another objective", "conflict")
    pivots = fixed_pivots(linkage, bodies)
    before = forces(motion, loads, about)
    given = _components(before, objective)
    seen = np.isfinite(given).all(axis=-1)
    if not seen.any():
        raise DesignError("motion", f"{objective} is unknown at all frames", "give frames that assemble", "conflict")
    effects = [_effects(motion, loads.gravity, body, pivots[body], objective, before.about)[seen] for body in bodies]
    if not np.any(effects):
        problem, remedy = f"counterweights on {', '.join(bodies)} have no effect on {objective}", "name other bodies"
        raise DesignError("bodies", problem, f"{remedy}, or give the motion a speed", "conflict")
    centred = [_deviation(values, objective) for values in (given[seen], *effects)]
    columns = np.concatenate([values.reshape(-1, values.shape[-1]) for values in centred[1:]], axis=1)
    # Rows of each frame, by their number of components; 0 for the mean square.
    grouped = given.shape[-1] if measure == "maximum" else 0
    moments, inertias = _best(columns, centred[0].reshape(-1), max_mass, max_radius, grouped)
    counterweights, masses = dict[str, Mass](), dict(loads.masses)
    for body, moment, inertia in zip(bodies, moments, inertias, strict=True):
        product = abs(moment)
        # The search keeps the bounds to its tolerance only.
        radius = min(max(inertia / product, product / max_mass), max_radius) if product else 0.0
        mass = min(product / radius, max_mass) if radius else 0.0
        # Nothing weighs less; such a counterweight has no effect.
        mass = mass if mass >= SMALLEST else 0.0
        direction = moment / product if mass else 0j
        counterweights[body] = Mass(float(mass), complex(pivots[body] + radius * direction))
        masses[body] = masses.get(body, Mass(0.0)) + counterweights[body]
    return Balance(objective, counterweights, before, forces(motion, replace(loads, masses=masses), about))


def fixed_pivots(linkage: Linkage, bodies: Sequence[str]) -> dict[str, complex]:
    """Each body's fixed pivot, mm in the body's frame."""
    if not bodies or len(set(bodies)) < len(bodies):
        raise DesignError("bodies", f"found {shown(bodies)}", "name one or more different bodies", "conflict")
    pivots = dict[str, complex]()
    fixed = {
        body: points[pin]
        for body, points in linkage.bodies.items()
        for pin in points
        if body != linkage.ground and pin in linkage.bodies[linkage.ground]
    }
    for body in bodies:
        known_body(linkage, body, "bodies")
        if body not in fixed:
            problem = f"found {shown(body)}, which turns on no pivot of {linkage.ground}"
            raise DesignError("bodies", problem, f"give some of {', '.join(fixed) or 'another linkage'}", "conflict")
        pivots[body] = complex(fixed[body])
    return pivots


def _components(analysis: ForceAnalysis, objective: BalanceObjective) -> Real:
    """The objective at each frame, (frames, components), N or N mm; for the driver its deviation from the mean."""
    if objective == "shaking_force":
        return np.stack([analysis.shaking_force.real, analysis.shaking_force.imag], axis=-1)
    values: Real = analysis.shaking_moment if objective == "shaking_moment" else analysis.driver
    return _deviation(values[..., None], objective)


def _deviation(values: Real, objective: BalanceObjective) -> Real:
    """The values, for the driver less their mean over the frames at which they are known."""
    known = np.isfinite(values).all(axis=tuple(range(1, values.ndim)))
    if objective != "driver" or not known.any():
        return values
    deviation: Real = values - values[known].mean(axis=0)
    return deviation


def _effects(
    motion: Motion, gravity: complex, body: str, pivot: complex, objective: BalanceObjective, about: complex | Complex
) -> Real:
    """Objective per unit of a body's first moment along x and y, and per unit of its inertia about the pivot.

    Shape (frames, components, 3). Effects that are rounding are 0.
    """
    radius = float(motion.linkage.size) or 1.0

    def probe(mass: Mass) -> ForceAnalysis:
        return ForceAnalysis(motion, Loads(gravity, {body: mass}), about)

    inertia = _components(probe(Mass(0.0, pivot, 1.0)), objective)
    weights = [probe(Mass(1.0, pivot + radius * unit)) for unit in (1, 1j)]
    moments = [_components(weight, objective) / radius - radius * inertia for weight in weights]
    # A mass on the far side of the linkage would have these effects if its forces had an arm of the linkage's size.
    largest = float(np.nanmax(np.abs([weight.shaking_force for weight in weights]), initial=0.0))
    scale = (largest / radius + NEWTON * abs(gravity) / radius) * (1.0 if objective == "shaking_force" else radius)
    groups = [np.stack(moments, axis=-1), inertia[..., None]]
    limits = NO_EFFECT * scale, NO_EFFECT * scale / radius
    known = [
        group if np.nanmax(np.abs(group), initial=0.0) > limit else np.zeros_like(group)
        for group, limit in zip(groups, limits, strict=True)
    ]
    return np.concatenate(known, axis=-1)


def size_of_objective(analysis: ForceAnalysis, objective: BalanceObjective, measure: BalanceMeasure) -> float:
    """Root mean square or largest size of an objective over the frames, N or N mm."""
    sizes = np.linalg.norm(_components(analysis, objective), axis=-1)
    return root_mean_square(sizes) if measure == "root_mean_square" else float(np.fmax.reduce(sizes, initial=0.0))


def _best(columns: Real, given: Real, max_mass: float, max_radius: float, grouped: int = 0) -> tuple[Complex, Real]:
    """First moments, kg mm, and inertias, kg mm2, of the counterweights: each shape (bodies,).

    columns: (rows, 3 x bodies), for each body those of the first moment along x and y and of the inertia. grouped: 0
    for the least mean square of all rows, or the number of rows of a frame, for the least maximum over the frames.
    A point mass within the bounds has |moment|2 <= max_mass inertia and inertia <= max_radius |moment|.
    """
    bodies, largest = columns.shape[1] // 3, float(np.linalg.norm(given))
    if not largest:
        return np.zeros(bodies, dtype=complex), np.zeros(bodies)
    sizes = np.linalg.norm(columns, axis=0).reshape(bodies, 3)
    has_inertia = sizes[:, 2] > 0
    # Units in which each unknown is of order 1.
    with np.errstate(divide="ignore"):
        unit = np.minimum(largest / np.hypot(sizes[:, 0], sizes[:, 1]), max_mass * max_radius)
        inertia_unit = np.minimum(largest / sizes[:, 2], unit * max_radius)
    units = np.stack([unit, unit, inertia_unit], axis=-1).reshape(-1)
    heaviest, farthest = unit / (max_mass * max_radius), inertia_unit / (unit * max_radius)
    # The same mean square, with as many rows as unknowns.
    reduced: Real = np.asarray(np.linalg.qr(np.column_stack([columns * units, given]) / largest, mode="r"))
    matrix, target = reduced[:, :-1], reduced[:, -1]

    def limits(shares: Real) -> Real:
        """Values that are at most 0 within the bounds, (2, bodies)."""
        x, y, inertia = shares.reshape(bodies, 3).T
        moment = np.hypot(x, y)
        over_mass = np.where(has_inertia, heaviest * moment**2 - farthest * inertia, heaviest * moment - 1)
        return np.stack([over_mass, np.where(has_inertia, farthest * inertia - moment, 0.0)])

    def slopes(shares: Real) -> Real:
        """Their derivatives, (2, bodies, 3 x bodies)."""
        x, y, _ = shares.reshape(bodies, 3).T
        moment = np.hypot(x, y)
        along = np.stack([x, y]) / np.where(moment == 0, 1.0, moment)
        jacobian = np.zeros((2, bodies, bodies, 3))
        for k in range(bodies):
            by_inertia = farthest[k] * has_inertia[k]
            growth = heaviest[k] * (2 * moment[k] if has_inertia[k] else 1.0)
            jacobian[0, k, k] = *(growth * along[:, k]), -by_inertia
            jacobian[1, k, k] = *(-along[:, k] * has_inertia[k]), by_inertia
        return jacobian.reshape(2 * bodies, 3 * bodies)

    def mean_square(shares: Real) -> float:
        return float(((matrix @ shares + target) ** 2).sum())

    free = np.linalg.lstsq(matrix, -target, rcond=NO_EFFECT)[0]
    best = np.zeros(3 * bodies)
    if (limits(free) <= 0).all():
        best = free
    else:
        for start in _starts(free, has_inertia, heaviest, farthest):
            shares = _local_optimum(matrix, target, limits, slopes, start)
            if mean_square(shares) < mean_square(best):
                best = shares
    if grouped:
        frames = (np.column_stack([columns * units, given]) / largest).reshape(-1, grouped, 3 * bodies + 1)
        starts = [best, *_starts(free, has_inertia, heaviest, farthest)]
        tries = [_least_maximum(frames[..., :-1], frames[..., -1], limits, slopes, start) for start in starts]
        best = min(tries, key=lambda found: found[1])[0]
    best = best.reshape(bodies, 3)
    best[(sizes == 0).all(axis=1) | (np.abs(best) <= NEGLIGIBLE).all(axis=1)] = 0.0
    x, y, inertia = (best * units.reshape(bodies, 3)).T
    moments = x + 1j * y
    return moments, np.where(has_inertia, inertia, max_radius * np.abs(moments))


def _starts(free: Real, has_inertia: Mask, heaviest: Real, farthest: Real) -> list[Real]:
    """Starts within the bounds: towards the optimum without bounds, then in random directions."""
    bodies, random = len(has_inertia), np.random.default_rng(0)
    x, y, _ = free.reshape(bodies, 3).T
    directions = [np.arctan2(y, x), *random.uniform(-np.pi, np.pi, (STARTS - 1 if has_inertia.any() else 0, bodies))]
    starts = []
    for angles in directions:
        moment = random.uniform(0.1, 0.9, bodies) / np.maximum(heaviest, 1.0)
        inertia = np.where(has_inertia, moment * (heaviest * moment + 1) / 2 / farthest, 0.0)
        starts.append(np.stack([moment * np.cos(angles), moment * np.sin(angles), inertia], axis=-1).reshape(-1))
    return starts


def _local_optimum(
    matrix: Real, target: Real, limits: Callable[[Real], Real], slopes: Callable[[Real], Real], start: Real
) -> Real:
    """The least mean square near a start, by sequential quadratic programming."""
    import nlopt

    best, least = start, np.inf

    def objective(shares: Real, gradient: Real) -> float:
        nonlocal best, least
        rest = matrix @ shares + target
        if gradient.size:
            gradient[:] = 2 * matrix.T @ rest
        if rest @ rest < least and (limits(shares) <= NO_EFFECT).all():
            best, least = shares.copy(), float(rest @ rest)
        return float(rest @ rest)

    def constraints(result: Real, shares: Real, gradient: Real) -> None:
        result[:] = limits(shares).reshape(-1)
        if gradient.size:
            gradient[:] = slopes(shares)

    solver = nlopt.opt(nlopt.LD_SLSQP, len(start))
    solver.set_min_objective(objective)
    solver.add_inequality_mconstraint(constraints, np.zeros(limits(start).size))
    solver.set_xtol_rel(CONVERGED)
    solver.set_maxeval(MOST_STEPS)
    # It fails if rounding leaves no further step; the best point is known.
    with suppress(nlopt.RoundoffLimited, nlopt.runtime_error):
        solver.optimize(start)
    return best


def _least_maximum(
    rows: Real, target: Real, limits: Callable[[Real], Real], slopes: Callable[[Real], Real], start: Real
) -> tuple[Real, float]:
    """The least maximum over frames near a start, and its square, by sequential quadratic programming.

    rows: (frames, components, unknowns). The square of the maximum is a further unknown, a bound on all frames.
    """
    import nlopt

    def squares(shares: Real) -> tuple[Real, Real]:
        rest = rows @ shares + target
        return rest, (rest**2).sum(axis=-1)

    # In units of the first maximum, so that the bounds of all frames are of order 1.
    unit = float(squares(start)[1].max()) or 1.0
    best, least = start, float(squares(start)[1].max())

    def objective(unknowns: Real, gradient: Real) -> float:
        if gradient.size:
            gradient[:] = 0.0
            gradient[-1] = 1.0
        return float(unknowns[-1])

    def constraints(result: Real, unknowns: Real, gradient: Real) -> None:
        nonlocal best, least
        shares = unknowns[:-1]
        rest, sizes = squares(shares)
        bounds = limits(shares).reshape(-1)
        if sizes.max() < least and (bounds <= NO_EFFECT).all():
            best, least = shares.copy(), float(sizes.max())
        result[:] = np.concatenate([sizes / unit - unknowns[-1], bounds])
        if gradient.size:
            gradient[:] = 0.0
            gradient[: len(sizes), :-1] = 2 * np.einsum("fc,fcu->fu", rest, rows) / unit
            gradient[: len(sizes), -1] = -1.0
            gradient[len(sizes) :, :-1] = slopes(shares)

    solver = nlopt.opt(nlopt.LD_SLSQP, len(start) + 1)
    solver.set_min_objective(objective)
    solver.add_inequality_mconstraint(constraints, np.zeros(len(rows) + limits(start).size))
    solver.set_xtol_rel(CONVERGED)
    solver.set_maxeval(MOST_STEPS)
    with suppress(nlopt.RoundoffLimited, nlopt.runtime_error):
        solver.optimize(np.append(start, 1.0))
    return best, least
