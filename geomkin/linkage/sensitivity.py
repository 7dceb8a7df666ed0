"""Derivatives of a motion by the sizes of its linkage, exact at every frame.

The poses of all bodies satisfy the conditions of the joints. Differentiated by a size, and by the drive as often as
needed, each condition is linear in the unknown derivatives, always with the same matrix: three linear systems give the
derivatives of positions and of first and second kinematic coefficients, for dyads and for iterated loops alike
(implicit function theorem). A tree of pins places the bodies on each other, so that only their angles are unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from difflib import get_close_matches
from functools import lru_cache
from itertools import pairwise
from math import comb, prod
from typing import Any

import numpy as np

from ..core.arguments import is_place
from ..core.errors import DesignError, shown
from ..core.records import record
from ..plane.vec import Array, Complex, Mask, Real
from .joints.slide import AbstractSlide
from .linkage import STRUCTURES, AbstractLinkage, Linkage, Structure
from .solve.loops import Loops
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
    """Points, mm, of all bodies; the sizes of each slide, angles in rad; origin; ground angle, rad.

    Shape (entries, *linkages).
    """
    entries: list[complex | Array] = [z for points in linkage.bodies.values() for z in points.values()]
    for joint in linkage.sized_joints:
        entries += [value * RAD if name.endswith("_deg") else value for name, value in joint.sizes.items()]
    entries += [linkage.origin, linkage.ground_angle_deg * RAD]
    shape = np.broadcast_shapes(*(np.shape(entry) for entry in entries))
    data: Complex = np.empty((len(entries), *shape), dtype=complex)
    for k, entry in enumerate(entries):
        data[k] = entry
    return data


def entry_numbers(linkage: Linkage) -> dict[tuple[str, str], int]:
    """Number of each entry of the data: by body and point, or by slider and field; ("", field) for the rest."""
    names = [(body, point) for body, points in linkage.bodies.items() for point in points]
    names += [(joint.name, field) for joint in linkage.sized_joints for field in joint.sizes]
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
    # All named linkages pass these three on.
    numbers, known = entry_numbers(general), {*field_names(linkage)} - {"origin.x", "origin.y", "ground_angle_deg"}
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
        steps[k] = _size(linkage, name)
    # A power of two between a quarter and half of a size: differences of linear data are then exact to rounding. The
    # smallest of all numbers have no power of two below them.
    steps = np.ldexp(1.0, np.maximum(np.frexp(steps)[1] - 2, -1000))
    above, below = _changed_data(linkage, names, np.stack([steps, -steps]))
    rounding = 8 * np.finfo(float).eps * (np.abs(above) + np.abs(below))
    rates: Complex = (above - below) / (2 * steps)
    if np.any(np.abs(above + below - 2 * linkage_data(linkage.linkage)[:, None]) > rounding):
        multiples = np.array([[k / 16, -k / 16] for k in ORDER_EIGHT]).reshape(-1, *(1,) * steps.ndim)
        data = _changed_data(linkage, names, multiples * steps)
        differences = [weight * (data[2 * k] - data[2 * k + 1]) for k, weight in enumerate(ORDER_EIGHT.values())]
        rates = 16 * np.sum(differences, axis=0) / steps
    return rates


def _size(linkage: AbstractLinkage, name: str) -> Real:
    """The value of a size of a named linkage, mm or deg."""
    value: Any = linkage
    path = name.split(".")
    while isinstance(value, AbstractLinkage):
        value, path = getattr(value, path[0]), path[1:]
    size: Real = np.imag(value) if path == ["y"] else np.real(value)
    return size


def _changed_data(linkage: AbstractLinkage, names: Sequence[str], changes: Real) -> Complex:
    """The linkage's data if some sizes change alone, several times; changes: (times, sizes, *linkages).

    Returns (times, entries, sizes, *linkages).
    """
    if names[0].endswith("_deg"):
        copies = [_changed(linkage, {names[0]: float(change.flat[0])}, 1) for change in changes]
        return np.array([linkage_data(copy.linkage)[:, None] for copy in copies])
    times, sizes = changes.shape[:2]
    alone = np.zeros((sizes, *changes.shape))
    alone[range(sizes), :, range(sizes)] = changes.swapaxes(0, 1)
    changed = _changed(linkage, dict(zip(names, alone.reshape(sizes, -1))), times * sizes)
    data = linkage_data(changed.linkage)
    data = np.broadcast_to(data, (len(data), changes.size)).reshape(len(data), *changes.shape)
    return data.swapaxes(0, 1)


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


@record(eq=False)
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
    bodies, slides, *_ = structure
    ids = {"transmission_angle": Quantity("angle", "", 0)}
    for body, *_ in bodies:
        ids |= {f"{body}_{what}": Quantity("body", body, k) for k, what in enumerate(("angle", "omega", "alpha"))}
    orders = "displacement", "velocity", "acceleration"
    for slider, *_ in slides:
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


def _pin_tree(linkage: Linkage) -> tuple[list[tuple[str, str, str]], list[tuple[str, str, str]]]:
    """Pins that place one body each on another one, as pin, other body and body, and the remaining pins.

    The bodies that no pin of the tree places are the ground and those without a chain of pins to bodies before them.
    """
    pairs = [(pin, one, two) for pin, bodies in linkage.pins.items() for one, two in pairwise(bodies)]
    tree: list[tuple[str, str, str]] = []
    reached: set[str] = set()
    for root in linkage.bodies:
        reached.add(root)
        while pair := next((pair for pair in pairs if len(reached & set(pair[1:])) == 1), None):
            pairs.remove(pair)
            pin, one, two = pair
            tree.append((pin, one, two) if one in reached else (pin, two, one))
            reached |= {one, two}
    return tree, pairs


def _not_zero(values: Complex) -> list[bool]:
    """Whether each row has a number that is not zero."""
    flags: list[bool] = (values != 0).reshape(len(values), -1).any(axis=1).tolist()
    return flags


def _product(order: int, one: Callable[[int], Array], two: Callable[[int], Array]) -> Array:
    """The derivative of a product, from functions that return those of its factors by order (Leibniz)."""
    product = one(order) * two(0)
    for k in range(1, order + 1):
        product = product + comb(order, k) * one(order - k) * two(k)
    return product


class SizeDerivatives:
    """Derivatives by some sizes of the poses over some frames, and of their derivatives by the drive.

    n is the number of frames times linkages. `origin` and `angle` hold for each order a derivative by the drive,
    differentiated by the sizes: (sizes or 1, n or 1) by body, mm and rad; bodies that do not turn have no angle. An
    order is solved on first use.
    """

    def __init__(self, solution: LinkageSolution, frames: slice, sizes: list[str], rates: Complex):
        self.solution, self.frames, self.sizes = solution, frames, sizes
        self.linkage = linkage = solution.linkage
        self.entries = entry_numbers(linkage)
        data = linkage_data(linkage)
        self.data = [self._flat(row) for row in data]
        self.not_zero = _not_zero(data)
        if linkage.is_batch:
            shape = (*rates.shape[:2], *solution.assembled[frames].shape)
            rates = np.broadcast_to(rates[:, :, None], shape).reshape(*rates.shape[:2], -1)
        self.rates = rates if linkage.is_batch else rates[..., None]
        self.changed = _not_zero(rates)
        self.scale = self._flat(np.where(linkage.size > 0, linkage.size, 1.0))
        self.n = solution.assembled[frames].size
        self._results: dict[Quantity, Array] = {}
        self._axes: dict[tuple[str, int], Complex] = {}
        self.origin: list[dict[str, Complex]] = []
        self.angle: list[dict[str, Real]] = []
        self.turned_by_drive = None if linkage.driven_slider else linkage.driver
        self.tree, self.loops = _pin_tree(linkage)
        placed = {linkage.ground, *(body for _, _, body in self.tree)}
        self.unknowns = [(b, "angle") for b in linkage.bodies if b not in (linkage.ground, self.turned_by_drive)]
        self.unknowns += [(b, axis) for b in linkage.bodies if b not in placed for axis in ("x", "y")]

    def _flat(self, values: Array) -> Array:
        """Values over the frames and linkages of this block in one row; a single number is kept."""
        values = np.asarray(values)
        if values.ndim and values.shape != self.solution.shape:
            values = np.broadcast_to(values, self.solution.shape)
        return values[self.frames].ravel() if values.ndim else values

    def _axis(self, body: str, order: int) -> Complex:
        """Direction of a body, or its derivative by the drive, (n,)."""
        if (body, order) not in self._axes:
            axis: Complex = self._flat(self.solution.value("direction", body))
            if order:
                turn = [self._flat(self.solution.value(k, body)) for k in ("first", "second")[:order]]
                axis = axis * (1j * turn[0] if order == 1 else 1j * turn[1] - turn[0] ** 2)
            self._axes[body, order] = axis
        return self._axes[body, order]

    def _place(self, body: str, owner: str, name: str, order: int) -> Complex:
        """A point of a body, or its derivative by the drive, (n,)."""
        origin: Complex = self._flat(self.solution.origin(body, order))
        return origin + self._axis(body, order) * self.data[self.entries[owner, name]]

    def _rate(self, owner: str, name: str) -> Complex:
        """Rates of an entry of the linkage's data, (sizes, 1 or n)."""
        rate: Complex = self.rates[self.entries[owner, name]]
        return rate

    def _point(self, body: str, owner: str, name: str, order: int) -> Complex:
        """Rates of a point of a body, or of its derivative by the drive, (sizes, n or 1)."""
        point, entry = self.origin[order][body], self.entries[owner, name]
        if order and body == self.linkage.ground:
            return point
        for k in range(order + 1 if self.not_zero[entry] else 0):
            if body in self.angle[k]:
                arm = self._axis(body, order - k) * (1j * comb(order, k) * self.data[entry])
                point = point + self.angle[k][body] * arm
        return point + self.rates[entry] * self._axis(body, order) if self.changed[entry] else point

    def _line(self, slider: AbstractSlide, order: int = 0) -> Complex:
        """Direction of a slider's line, or its derivative by the drive, (n,)."""
        return self._axis(slider.along, order) * slider.direction

    def _slide(self, slider: AbstractSlide, order: int) -> Complex:
        """Rates of the sliding point relative to the line's own frame, along it and to its left, (sizes, n)."""
        ends = (slider.body, *slider.point_entry), (slider.along, slider.name, "through")

        def line(k: int) -> Complex:
            return np.conj(self._line(slider, k))

        def relative(k: int) -> Complex:
            return _product(k, line, lambda j: np.subtract(*(self._place(*end, j) for end in ends)))

        def turned(k: int) -> Real:
            """The line itself turns by the rate of its guide and of its direction there."""
            rate: Real = self.angle[k].get(slider.along, np.zeros((1, 1)))
            return rate if k else rate + self._rate(slider.name, "direction_deg").real

        moved = _product(order, line, lambda k: np.subtract(*(self._point(*end, k) for end in ends)))
        return moved - 1j * _product(order, relative, turned)

    def _closure(self, order: int) -> Real:
        """Rates of the errors of the joints outside the tree of pins, (rows, sizes, n)."""
        rows: list[Real | float] = []
        for pin, *bodies in self.loops:
            one, two = (self._point(body, body, pin, order) for body in bodies)
            apart = (one - two) * (1 / self.scale)
            rows += [apart.real, apart.imag]
        for slider in self.linkage.slides:
            relative = self._slide(slider, order) * (1 / self.scale)
            rows.append(relative.imag)
            if slider is self.linkage.driven_slider:
                rows.append(relative.real)
            if not slider.is_aligned:
                continue
            turned = self.angle[order].get(slider.body, 0.0) - self.angle[order].get(slider.along, 0.0)
            if order == 0:
                turned = turned - sum(self._rate(slider.name, f"{w}_deg").real for w in ("direction", "angle"))
            rows.append(turned)
        for mesh in self.linkage.meshes:
            # Angles are those from +x, those of a mesh from the ground.
            ground = self.angle[order].get(self.linkage.ground, 0.0)
            first, second = (self.angle[order].get(body, 0.0) - ground for body in mesh.bodies)
            turned = second - mesh.ratio_of(mesh.bodies[1]) * first
            rows.append(turned if order else turned - self._rate(mesh.name, "angle_deg").real)
        errors = np.empty((len(rows), self.rates.shape[1], self.n))
        for error, row in zip(errors, rows):
            error[:] = row
        return errors

    def _move(self, order: int, unknowns: Real) -> None:
        """Set the rates of an order from those of the unknowns, (unknowns, sizes, n or 1); zero if none are given."""
        ground = self.linkage.ground
        origin: dict[str, Complex] = dict.fromkeys(self.linkage.bodies, np.zeros((1, 1), dtype=complex))
        angle: dict[str, Real] = {}
        if order == 0:
            origin[ground], angle[ground] = self._rate("", "origin"), self._rate("", "ground_angle_deg").real
            if self.turned_by_drive:
                # The driver's angle is measured from the ground.
                angle[self.turned_by_drive] = angle[ground]
        for (body, axis), values in zip(self.unknowns, unknowns):
            if axis == "angle":
                angle[body] = values
            else:
                origin[body] = origin[body] + values * self.scale * (1j if axis == "y" else 1)
        self.origin[order:], self.angle[order:] = [origin], [angle]
        for pin, other, body in self.tree:
            origin[body] = self._point(other, other, pin, order) - self._point(body, body, pin, order)

    def _solve(self, order: int) -> None:
        """Add the rates of one more order."""
        count = len(self.unknowns)
        with np.errstate(all="ignore"):
            if order == 0:
                # The matrix is the same for all orders: each unknown changes alone, while all sizes are constant.
                rates, changed = self.rates, self.changed
                self.rates, self.changed = np.zeros((len(rates), count, 1), dtype=complex), [False] * len(rates)
                self._move(0, np.eye(count)[..., None])
                matrices = np.moveaxis(self._closure(0), -1, 0)
                self.inverse = np.ascontiguousarray(np.moveaxis(_inverted(matrices), 0, -1))
                self.origin_rates = {body: rate for body, rate in self.origin[0].items() if rate.any()}
                self.rates, self.changed = rates, changed
            self._move(order, np.zeros(0))
            unknowns = np.einsum("urn,rsn->usn", self.inverse, -self._closure(order))
            for body, rate in self.origin_rates.items():
                self.origin[order][body] = self.origin[order][body] + np.einsum("un,usn->sn", rate, unknowns)
            self.angle[order] |= {b: rate for (b, axis), rate in zip(self.unknowns, unknowns) if axis == "angle"}

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
        values = np.broadcast_to(values, (len(self.sizes), self.n))
        return values if not quantity.part else values.real if quantity.part == "x" else values.imag

    def _coefficient(self, quantity: Quantity, order: int) -> Array:
        """Rates of a position, or of its kinematic coefficient, (sizes, n)."""
        while len(self.origin) <= order:
            self._solve(len(self.origin))
        if quantity.kind == "body":
            return self.angle[order].get(quantity.name, np.zeros((1, 1)))
        if quantity.kind == "slider":
            return self._slide(self._slider(quantity.name), order).real
        body = self._body_of(quantity.name)
        return self._point(body, body, quantity.name, order)

    def _slider(self, name: str) -> AbstractSlide:
        return next(slide for slide in self.linkage.slides if slide.name == name)

    def _body_of(self, point: str) -> str:
        return next(body for body, points in self.linkage.bodies.items() if point in points)

    def _transmission_angle(self) -> Real:
        """Rates of the smallest transmission angle; nan if loops are solved together, and where it is folded."""
        self._coefficient(Quantity("body", self.linkage.ground, 0), 0)
        angles: list[tuple[Real, Real]] = [self._angle_between(*lines) for lines in self.solution.joint_lines]
        if self.solution.run is None:
            loops = [placement for placement in self.solution.placements if isinstance(placement, Loops)]
            known = (placement.transmission_angle(self.solution.poses) for placement in loops)
            angles += [(self._flat(angle), np.asarray(np.nan)) for angle in known]
        least, rates = np.full(self.n, np.nan), np.full((len(self.sizes), self.n), np.nan)
        for angle, rate in angles:
            smaller = np.isnan(least) | (angle < least)
            least, rates = np.where(smaller, angle, least), np.where(smaller, rate, rates)
        return rates

    def _angle_between(self, *lines: tuple[str, str] | str) -> tuple[Real, Real]:
        """The transmission angle of two members, (n,), and its rates, (sizes, n)."""
        directions, turned = zip(*map(self._joint_line, lines))
        between = directions[1] * np.conj(directions[0])
        # A bar moves its joint across its length, a slide along its line.
        between = between * 1j if isinstance(lines[0], str) != isinstance(lines[1], str) else between
        sine_cosine = between.real * between.imag
        folded = np.abs(sine_cosine) <= FOLD * np.abs(between) ** 2
        rate = np.where(folded, np.nan, np.sign(sine_cosine)) * (turned[1] - turned[0])
        return np.arctan2(np.abs(between.imag), np.abs(between.real)), rate

    def _joint_line(self, line: tuple[str, str] | str) -> tuple[Complex, Real]:
        """Direction of the line through two points, or of a slider, and the rates of its angle, (sizes, n)."""
        if isinstance(line, str):
            slider = self._slider(line)
            turned: Real = self.angle[0].get(slider.along, 0.0) + self._rate(line, "direction_deg").real
            return self._line(slider), turned
        bodies = [self._body_of(point) for point in line]
        places = [self._place(body, body, point, 0) for body, point in zip(bodies, line)]
        rates = [self._point(body, body, point, 0) for body, point in zip(bodies, line)]
        bar, rate = places[1] - places[0], rates[1] - rates[0]
        with np.errstate(all="ignore"):
            return bar, (rate * (1 / bar)).imag


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
