"""Derivatives of a motion by the sizes of its linkage, exact at every frame.

The poses of all bodies satisfy the conditions of the joints. Differentiated by a size, and by the drive as often as
needed, each condition is linear in the unknown derivatives, always with the same matrix: three linear systems give the
derivatives of positions and of first and second kinematic coefficients, for dyads and for iterated loops alike
(implicit function theorem).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from difflib import get_close_matches
from functools import cached_property, lru_cache
from itertools import pairwise
from math import prod
from typing import Any

import numpy as np

from ..core.arguments import is_place
from ..core.errors import DesignError, shown
from ..core.records import record
from ..plane.vec import Array, Complex, Mask, Real
from .linkage import STRUCTURES, AbstractLinkage, Linkage, Slider, Structure
from .solve.dyads import Crossed, Dyad
from .solve.solution import LinkageSolution

# Frames times linkages that are solved at once. With more the matrices take hundreds of megabytes; with fewer calling
# NumPy takes longer than the arithmetic.
BLOCK = 4096
# Weights of central differences of order eight, for sizes in which a linkage's points are not linear.
ORDER_EIGHT = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
# Distance from 0 or 90 deg, rad, within which a transmission angle has no derivative: there it is folded back.
FOLD = 1e-12
RAD = np.pi / 180

# --- Sizes: derivatives of the general linkage's data by each named size.


def linkage_data(linkage: Linkage) -> Complex:
    """Points, mm, of all bodies; of each slider point, through, direction and angle; origin; ground angle, rad.

    Shape (entries, *linkages).
    """
    entries: list[complex | Array] = [z for points in linkage.bodies.values() for z in points.values()]
    for s in linkage.sliders:
        entries += [s.point, s.through, s.direction_deg * RAD, s.angle_deg * RAD]
    entries += [linkage.origin, linkage.ground_angle_deg * RAD]
    shape = np.broadcast_shapes(*(np.shape(entry) for entry in entries))
    data: Complex = np.empty((len(entries), *shape), dtype=complex)
    for k, entry in enumerate(entries):
        data[k] = entry
    return data


def entry_numbers(linkage: Linkage) -> dict[tuple[str, str], int]:
    """Number of each entry of the data: by body and point, or by slider and field; ("", field) for the rest."""
    names = [(body, point) for body, points in linkage.bodies.items() for point in points]
    names += [(s.name, field) for s in linkage.sliders for field in ("point", "through", "direction_deg", "angle_deg")]
    return {name: k for k, name in enumerate([*names, ("", "origin"), ("", "ground_angle_deg")])}


def size_names(linkage: AbstractLinkage) -> list[str]:
    """Names of all sizes: fields of a named linkage, then points and sliders of the general one.

    A size that is a point has two names, its coordinates, such as `coupler_point.x` and `coupler_point.y`.
    """
    general = []
    for owner, name in entry_numbers(linkage.linkage):
        text = f"{owner}.{name}" if owner else name
        general += [text] if name.endswith("_deg") else [f"{text}.x", f"{text}.y"]
    return list(dict.fromkeys([*field_names(linkage), *general]))


def field_names(linkage: AbstractLinkage) -> Iterator[str]:
    """Names of the sizes of a named linkage; those of a point by its coordinates."""
    if isinstance(linkage, Linkage):
        return
    for field in fields(linkage):  # type: ignore[arg-type]
        value = getattr(linkage, field.name)
        if isinstance(value, AbstractLinkage):
            yield from (f"{field.name}.{name}" for name in field_names(value))
        elif "unit" in field.metadata:
            yield field.name
        elif not isinstance(value, bool) and is_place(value):
            yield from (f"{field.name}.x", f"{field.name}.y")


def size_rates(linkage: AbstractLinkage, names: Sequence[str]) -> Complex:
    """Derivatives of the linkage's data by some of its sizes, per mm or per rad, (entries, sizes, *linkages)."""
    general = linkage.linkage
    numbers, known = entry_numbers(general), set(field_names(linkage))
    rates = np.zeros((len(numbers), len(names), *general.shape), dtype=complex)
    # Lengths and points are changed in one copy of the linkage, as arrays; angles may not be arrays.
    lengths = [k for k, name in enumerate(names) if name in known and not name.endswith("_deg")]
    if lengths:
        rates[:, lengths] = _field_rates(linkage, [names[k] for k in lengths])
    for k, name in enumerate(names):
        if name in known:
            if name.endswith("_deg"):
                rates[:, k] = _field_rates(linkage, [name])[:, 0] / RAD
            continue
        text, _, axis = name.rpartition(".") if name[-2:] in (".x", ".y") else (name, "", "")
        owner, _, entry = text.rpartition(".")
        rates[numbers[owner, entry], k] = 1j if axis == "y" else 1
    return rates


def _field_rates(linkage: AbstractLinkage, names: Sequence[str]) -> Complex:
    """Derivatives of the data of a named linkage by lengths and points, per mm, or by one angle, per deg."""
    steps = np.empty((len(names), *linkage.linkage.shape))
    for k, name in enumerate(names):
        steps[k] = _step(linkage, name)

    def data(multiple: float) -> Complex:
        return _changed_data(linkage, names, multiple * steps)

    above, below, here = data(1.0), data(-1.0), linkage_data(linkage.linkage)[:, None]
    rounding = 8 * np.finfo(float).eps * (np.abs(above) + np.abs(below))
    rates: Complex = (above - below) / (2 * steps)
    if np.any(np.abs(above + below - 2 * here) > rounding):
        differences = [weight * (data(k / 16) - data(-k / 16)) for k, weight in ORDER_EIGHT.items()]
        rates = 16 * np.sum(differences, axis=0) / steps
    return rates


def _step(linkage: AbstractLinkage, name: str) -> Real:
    """A power of two between a quarter and half of a size: differences of linear data are then exact to rounding."""
    value: Any = linkage
    path = name.split(".")
    while isinstance(value, AbstractLinkage):
        value, path = getattr(value, path[0]), path[1:]
    exponent = np.frexp(np.imag(value) if path == ["y"] else np.real(value))[1] - 2
    # The smallest of all numbers have no power of two below them.
    step: Real = np.ldexp(1.0, np.maximum(exponent, -1000))
    return step


def _changed_data(linkage: AbstractLinkage, names: Sequence[str], changes: Real) -> Complex:
    """The linkage's data with each of some sizes changed alone; changes and result: (entries,) sizes, *linkages."""
    copies, *shape = changes.shape
    if names[0].endswith("_deg"):
        return linkage_data(_changed(linkage, {names[0]: float(changes.flat[0])}, 1).linkage)[:, None]
    rows = {}
    for k, name in enumerate(names):
        row = np.zeros(changes.shape)
        row[k] = changes[k]
        rows[name] = row.ravel()
    data = linkage_data(_changed(linkage, rows, copies).linkage)
    return np.broadcast_to(data, (len(data), changes.size)).reshape(len(data), copies, *shape)


def _changed(linkage: AbstractLinkage, changes: Mapping[str, Real | float], copies: int) -> AbstractLinkage:
    """Copies of a linkage, as arrays, with changed sizes. They are not checked, since a step may leave their range."""
    values: dict[str, Any] = {}
    for field in fields(linkage):  # type: ignore[arg-type]
        value = getattr(linkage, field.name)
        own = {name[len(field.name) + 1 :]: change for name, change in changes.items()
               if name.partition(".")[0] == field.name}  # fmt: skip
        if isinstance(value, AbstractLinkage):
            value = _changed(value, own, copies)
        else:
            value = np.tile(value, copies) if isinstance(value, np.ndarray) and len(value) > 1 else value
            for axis, change in own.items():
                value = value + (1j * change if axis == "y" else change)
        values[field.name] = value
    changed = object.__new__(type(linkage))
    changed.__dict__.update(values)
    return changed


# --- Quantities: what a motion reports, by the ids of its table.


@record
class Quantity:
    """kind: "point", "body", "slider" or "angle"; order: of its derivative by time; part: "x", "y" or "" for both."""

    kind: str
    name: str
    order: int
    part: str = ""


def quantities(linkage: Linkage) -> Mapping[str, Quantity]:
    """All quantities that can be differentiated, by id."""
    return _quantities(linkage.structure)


@lru_cache(STRUCTURES)
def _quantities(structure: Structure) -> Mapping[str, Quantity]:
    bodies, sliders, _ = structure
    ids = {"transmission_angle": Quantity("angle", "", 0)}
    for body, *_ in bodies:
        ids |= {f"{body}_{what}": Quantity("body", body, k) for k, what in enumerate(("angle", "omega", "alpha"))}
    orders = "displacement", "velocity", "acceleration"
    for slider, *_ in sliders:
        ids |= {f"{slider}_{what}": Quantity("slider", slider, k) for k, what in enumerate(orders)}
    for point in dict.fromkeys(point for _, *points in bodies for point in points):
        for k, suffix in enumerate(("", "_velocity", "_acceleration")):
            ids |= {f"{point}{suffix}{'_' * bool(p)}{p}": Quantity("point", point, k, p) for p in ("", "x", "y")}
    return ids


class Sensitivities:
    """Derivatives of the quantities of one motion by the sizes of its linkage, computed when requested."""

    def __init__(self, solution: LinkageSolution, given: AbstractLinkage):
        self.solution, self.given = solution, given
        self.quantities = quantities(solution.linkage)
        self.fields = list(field_names(given))
        self._blocks: dict[str, list[SizeDerivatives]] = {}

    def of(self, quantity: str, size: str) -> Array:
        """The derivative of a quantity by a size, shape of the motion."""
        if quantity not in self.quantities:
            raise _unknown("of", quantity, list(self.quantities), "quantity")
        blocks = self._blocks[size] if size in self._blocks else self._solved(size)
        rates = [block.of(self.quantities[quantity])[block.sizes.index(size)] for block in blocks]
        joined = rates[0] if len(rates) == 1 else np.concatenate(rates)
        return joined.reshape(self.solution.shape)

    def _solved(self, size: str) -> list[SizeDerivatives]:
        names = size_names(self.given)
        if size not in names:
            raise _unknown("by", size, names, "size")
        frames, linkages = self.solution.shape[0], prod(self.solution.shape[1:])
        step = max(1, BLOCK // max(1, linkages))
        if frames > step:
            return [self._derivatives([size], slice(k, k + step)) for k in range(0, frames, step)]
        # All sizes of a named linkage at once cost little more than one, and are kept.
        sizes = self.fields if size in self.fields else [size]
        blocks = [self._derivatives(sizes, slice(None))]
        self._blocks |= dict.fromkeys(sizes, blocks)
        return blocks

    def _derivatives(self, sizes: list[str], frames: slice) -> SizeDerivatives:
        return SizeDerivatives(self.solution, frames, sizes, size_rates(self.given, sizes))


def _unknown(field: str, name: str, known: list[str], meaning: str) -> DesignError:
    near = get_close_matches(name, known, 3, 0.4)
    remedy = f"give {' or '.join(near or known[:3])}"
    return DesignError(field, f"found {shown(name)}, which is the name of no {meaning}", remedy, "unknown-key")


class SizeDerivatives:
    """Derivatives by some sizes of the poses over some frames, and of their derivatives by the drive.

    n is the number of frames times linkages. `origin` and `angle` hold for each order a derivative by the drive,
    differentiated by the sizes: (sizes, n) for each body, mm and rad; an order is solved on first use.
    """

    def __init__(self, solution: LinkageSolution, frames: slice, sizes: list[str], rates: Complex):
        self.solution, self.frames, self.sizes = solution, frames, sizes
        self.linkage = linkage = solution.linkage
        self.bodies = {name: k for k, name in enumerate(linkage.bodies)}
        self.entries = entry_numbers(linkage)
        self.data = [self._flat(row) for row in linkage_data(linkage)]
        if linkage.is_batch:
            shape = (*rates.shape[:2], *solution.assembled[frames].shape)
            rates = np.broadcast_to(rates[:, :, None], shape).reshape(*rates.shape[:2], -1)
        self.rates = rates if linkage.is_batch else rates[..., None]
        self.scale = self._flat(np.where(linkage.size > 0, linkage.size, 1.0))
        self.n = solution.assembled[frames].size
        self._results: dict[Quantity, Array] = {}
        self.origin: list[list[Complex]] = []
        self.angle: list[list[Real]] = []
        unknown = [b for b in linkage.bodies if b != linkage.ground]
        self.turned_by_drive = None if linkage.driven_slider else linkage.driver
        columns = [
            (b, axis) for b in unknown for axis in ("x", "y", "angle") if (b, axis) != (self.turned_by_drive, "angle")
        ]
        self.columns = {column: k for k, column in enumerate(columns)}

    def _flat(self, values: Array) -> Array:
        """Values over the frames and linkages of this block in one row; a single number is kept."""
        values = np.asarray(values)
        if values.ndim and values.shape != self.solution.shape:
            values = np.broadcast_to(values, self.solution.shape)
        return values[self.frames].ravel() if values.ndim else values

    @cached_property
    def _direction(self) -> list[Complex]:
        return [self._flat(self.solution.value("direction", body)) for body in self.bodies]

    @cached_property
    def _origins(self) -> list[list[Complex]]:
        """Origins of the bodies and their derivatives by the drive."""
        return [[self._flat(self.solution.origin(body, k)) for body in self.bodies] for k in range(3)]

    @cached_property
    def _turn(self) -> list[list[Real]]:
        """First and second derivatives of the bodies' angles by the drive."""
        return [[], *([self._flat(self.solution.value(k, body)) for body in self.bodies] for k in ("first", "second"))]

    def _entry(self, owner: str, name: str) -> tuple[Complex, Complex]:
        """Data of the linkage and its rates, (sizes, 1 or n)."""
        k = self.entries[owner, name]
        return self.data[k], self.rates[k]

    def _point(self, body: str, local: tuple[Complex, Complex], order: int) -> Complex:
        """Rates of a point of a body, or of its derivative by the drive, (sizes, n)."""
        b, (place, place_rate) = self.bodies[body], local
        arm = self._direction[b] * place
        arm_rate = 1j * self.angle[0][b] * arm + self._direction[b] * place_rate
        if order == 0:
            return self.origin[0][b] + arm_rate
        first, first_rate = self._turn[1][b], self.angle[1][b]
        if order == 1:
            return self.origin[1][b] + 1j * (first_rate * arm + first * arm_rate)
        turning = (1j * self.angle[2][b] - 2 * first * first_rate) * arm
        return self.origin[2][b] + turning + (1j * self._turn[2][b] - first**2) * arm_rate

    def _place(self, body: str, local: Complex, order: int) -> Complex:
        """A point of a body, or its derivative by the drive, (n,)."""
        b = self.bodies[body]
        arm = self._direction[b] * local
        if order == 0:
            return self._origins[0][b] + arm
        if order == 1:
            return self._origins[1][b] + 1j * self._turn[1][b] * arm
        return self._origins[2][b] + (1j * self._turn[2][b] - self._turn[1][b] ** 2) * arm

    def _line(self, slider: Slider) -> Complex:
        return self._direction[self.bodies[slider.along]] * slider.direction

    def _slide(self, slider: Slider, order: int) -> Complex:
        """Rates of the sliding point relative to the line's own frame, along it and to its left, (sizes, n)."""
        point, through = self._entry(slider.name, "point"), self._entry(slider.name, "through")
        guide = self.bodies[slider.along]
        apart = [
            self._place(slider.body, point[0], k) - self._place(slider.along, through[0], k) for k in range(order + 1)
        ]
        rates = [self._point(slider.body, point, k) - self._point(slider.along, through, k) for k in range(order + 1)]
        # The line itself turns by the rate of its guide and of its direction there.
        turned = 1j * (self.angle[0][guide] + self._entry(slider.name, "direction_deg")[1].real)
        if order == 0:
            relative, rate = apart[0], rates[0]
        else:
            h, h_rate = self._turn[1][guide], self.angle[1][guide]
            if order == 1:
                relative = apart[1] - 1j * h * apart[0]
                rate = rates[1] - 1j * (h_rate * apart[0] + h * rates[0])
            else:
                spin, spin_rate = 1j * self._turn[2][guide] + h * h, 1j * self.angle[2][guide] + 2 * h * h_rate
                relative = apart[2] - 2j * h * apart[1] - spin * apart[0]
                rate = rates[2] - 2j * (h_rate * apart[1] + h * rates[1]) - spin_rate * apart[0] - spin * rates[0]
        return np.conj(self._line(slider)) * (rate - turned * relative)

    @cached_property
    def _pairs(self) -> list[tuple[str, str, str]]:
        """Pin, and two bodies that it joins."""
        return [(pin, one, two) for pin, bodies in self.linkage.pins.items() for one, two in pairwise(bodies)]

    def _closure(self, order: int) -> Real:
        """Rates of the errors of all joints while the unknown rates of this order are zero, (rows, sizes, n)."""
        rows: list[Real] = []
        for pin, one, two in self._pairs:
            apart = self._point(one, self._entry(one, pin), order) - self._point(two, self._entry(two, pin), order)
            rows += [apart.real / self.scale, apart.imag / self.scale]
        for slider in self.linkage.sliders:
            relative = self._slide(slider, order)
            rows.append(relative.imag / self.scale)
            if slider is self.linkage.driven_slider:
                rows.append(relative.real / self.scale)
            body, guide = self.bodies[slider.body], self.bodies[slider.along]
            turned = self.angle[order][body] - self.angle[order][guide]
            if order == 0:
                turned = turned - sum(
                    self._entry(slider.name, f"{what}_deg")[1].real for what in ("direction", "angle")
                )
            rows.append(turned)
        errors = np.empty((len(rows), len(self.sizes), self.n))
        for error, row in zip(errors, rows):
            error[:] = row
        return errors

    @cached_property
    def _inverse(self) -> Real:
        """Inverse of the derivatives of all joints' errors by the unknowns, (columns, rows, n); nan at a limit."""
        matrix = np.zeros((self.n, len(self.columns), len(self.columns)))
        row = 0

        def put(body: str, axis: str, row: int, values: Real | float) -> None:
            if (body, axis) in self.columns:
                matrix[:, row, self.columns[body, axis]] = values

        for pin, *bodies in self._pairs:
            for body, sign in zip(bodies, (1, -1)):
                arm = sign * 1j * self._direction[self.bodies[body]] * self._entry(body, pin)[0] / self.scale
                for k, (axis, part) in enumerate((("x", arm.real), ("y", arm.imag))):
                    put(body, axis, row + k, sign)
                    put(body, "angle", row + k, part)
            row += 2
        for slider in self.linkage.sliders:
            line = np.conj(self._line(slider))
            point = self._place(slider.body, self._entry(slider.name, "point")[0], 0)
            for across in (True, False) if slider is self.linkage.driven_slider else (True,):
                for body, sign in ((slider.body, 1), (slider.along, -1)):
                    arm = 1j * (point - self._origins[0][self.bodies[body]]) / self.scale
                    for axis, moved in (("x", line), ("y", 1j * line), ("angle", arm * line)):
                        put(body, axis, row, sign * (moved.imag if across else moved.real))
                row += 1
            put(slider.body, "angle", row, 1)
            put(slider.along, "angle", row, -1)
            row += 1
        return np.ascontiguousarray(np.moveaxis(_inverted(matrix), 0, -1))

    def _solve(self, order: int) -> None:
        """Add the rates of one more order."""
        shape = len(self.sizes), self.n
        origin: list[Complex] = [np.zeros(shape, dtype=complex) for _ in self.bodies]
        angle: list[Real] = [np.zeros(shape) for _ in self.bodies]
        ground = self.bodies[self.linkage.ground]
        if order == 0:
            origin[ground][:] = self._entry("", "origin")[1]
            angle[ground][:] = self._entry("", "ground_angle_deg")[1].real
            if self.turned_by_drive:
                # The driver's angle is measured from the ground.
                angle[self.bodies[self.turned_by_drive]] = angle[ground]
        self.origin.append(origin)
        self.angle.append(angle)
        with np.errstate(all="ignore"):
            rates = np.einsum("crn,rsn->csn", self._inverse, -self._closure(order))
        for (body, axis), values in zip(self.columns, rates):
            b = self.bodies[body]
            if axis == "angle":
                angle[b] = values
            else:
                origin[b] += values * self.scale * (1j if axis == "y" else 1)

    def of(self, quantity: Quantity) -> Array:
        """Rates of a quantity, (sizes, n)."""
        if quantity not in self._results:
            self._results[quantity] = self._rates_of(quantity)
        return self._results[quantity]

    def _rates_of(self, quantity: Quantity) -> Array:
        if quantity.kind == "angle":
            return self._transmission_angle()
        speed, acceleration = (
            self._flat(rate) for rate in (self.solution.timing.speed, self.solution.timing.acceleration)
        )
        with np.errstate(all="ignore"):
            values = self._coefficient(quantity, quantity.order)
            if quantity.order == 1:
                values = values * speed
            elif quantity.order == 2:
                values = values * speed**2
                if np.any(acceleration):
                    values = values + self._coefficient(quantity, 1) * acceleration
        return values if not quantity.part else values.real if quantity.part == "x" else values.imag

    def _coefficient(self, quantity: Quantity, order: int) -> Array:
        """Rates of a position, or of its kinematic coefficient, (sizes, n)."""
        while len(self.origin) <= order:
            self._solve(len(self.origin))
        if quantity.kind == "body":
            return self.angle[order][self.bodies[quantity.name]]
        if quantity.kind == "slider":
            return self._slide(next(s for s in self.linkage.sliders if s.name == quantity.name), order).real
        body = self._body_of(quantity.name)
        return self._point(body, self._entry(body, quantity.name), order)

    def _body_of(self, point: str) -> str:
        return next(body for body, points in self.linkage.bodies.items() if point in points)

    def _transmission_angle(self) -> Real:
        """Rates of the smallest transmission angle; nan if loops are solved together, and where it is folded."""
        self._coefficient(Quantity("body", self.linkage.ground, 0), 0)
        least, rates = np.full(self.n, np.nan), np.full((len(self.sizes), self.n), np.nan)
        for placement in self.solution.placements:
            angle = placement.transmission_angle(self.solution.poses)
            if angle is None:
                continue
            angle = self._flat(angle)
            smaller = np.isnan(least) | (angle < least)
            least = np.where(smaller, angle, least)
            if not isinstance(placement, Dyad | Crossed):
                rates[:, smaller] = np.nan
                continue
            lines = placement.joint_lines
            directions, turned = zip(*map(self._joint_line, lines))
            between = directions[1] * np.conj(directions[0])
            # A bar moves its joint across its length, a slide along its line.
            between = between * 1j if isinstance(lines[0], Slider) != isinstance(lines[1], Slider) else between
            sine_cosine = between.real * between.imag
            folded = np.abs(sine_cosine) <= FOLD * np.abs(between) ** 2
            fold = np.where(folded, np.nan, np.sign(sine_cosine))
            rates = np.where(smaller, fold * (turned[1] - turned[0]), rates)
        return rates

    def _joint_line(self, line: tuple[str, str] | Slider) -> tuple[Complex, Real]:
        """Direction of the line through two points, or of a slider, and the rates of its angle, (sizes, n)."""
        if isinstance(line, Slider):
            turned = self.angle[0][self.bodies[line.along]] + self._entry(line.name, "direction_deg")[1].real
            return self._line(line), turned
        bodies = [self._body_of(point) for point in line]
        places = [self._place(body, self._entry(body, point)[0], 0) for body, point in zip(bodies, line)]
        rates = [self._point(body, self._entry(body, point), 0) for body, point in zip(bodies, line)]
        bar, rate = places[1] - places[0], rates[1] - rates[0]
        with np.errstate(all="ignore"):
            return bar, (rate / bar).imag


def _inverted(matrices: Real) -> Real:
    """Inverses of (n, k, k); nan where a matrix is singular or not finite."""
    regular: Mask = np.logical_and.reduce(np.isfinite(matrices), axis=(1, 2))
    try:
        inverse = np.linalg.inv(matrices)
    except np.linalg.LinAlgError:
        # One singular matrix makes `inv` refuse all. A sign of zero means a pivot of zero.
        regular[regular] = np.linalg.slogdet(matrices[regular])[0] != 0
        inverse = np.empty_like(matrices)
        inverse[regular] = np.linalg.inv(matrices[regular])
    inverse[~regular] = np.nan
    return inverse
