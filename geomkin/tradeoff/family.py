"""How methods are compared: a family with its problem and exact answer, or a cell near a singular position."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from decimal import Decimal, localcontext
from functools import partial
from typing import Any

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Array, Real


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


# Digits of results; computation uses more, since linkages near a toggle lose half of them.
DIGITS = 50
WORKING_DIGITS = 2 * DIGITS + 10
# Step of central differences, rad or mm. Their error is its square, and their rounding leaves as many digits.
STEP = Decimal("1e-25")
# Steps of a whole turn of the crank, and numbers of entries with which tables are tried.
FRAMES, ENTRIES = 360, (100.0, 1000.0, 10000.0)


@record
class DecimalComplex:
    """A complex number in decimals."""

    real: Decimal
    imag: Decimal = Decimal(0)

    @classmethod
    def of(cls, value: Any) -> DecimalComplex:
        """A real or complex number, at exactly its value."""
        return cls(Decimal(value.real), Decimal(value.imag))

    def __add__(self, other: Any) -> DecimalComplex:
        other = DecimalComplex.of(other)
        return DecimalComplex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: Any) -> DecimalComplex:
        return self + DecimalComplex.of(other) * Decimal(-1)

    def __mul__(self, other: Any) -> DecimalComplex:
        a, b, other = self.real, self.imag, DecimalComplex.of(other)
        return DecimalComplex(a * other.real - b * other.imag, a * other.imag + b * other.real)

    def conjugate(self) -> DecimalComplex:
        """The conjugate."""
        return DecimalComplex(self.real, -self.imag)

    @property
    def square(self) -> Decimal:
        """Square of the absolute value."""
        return self.real * self.real + self.imag * self.imag

    @property
    def direction(self) -> DecimalComplex:
        """Unit vector."""
        return self * (1 / self.square.sqrt())


def circling(radius: float | Decimal, angle: Decimal) -> DecimalComplex:
    """A point of a crank about the origin, by the series of cosine and sine, for an angle of a few turns."""
    parts, term, k = [Decimal(0), Decimal(0)], Decimal(radius), 0
    while abs(term) > Decimal(10) ** -WORKING_DIGITS or k < abs(angle):
        parts[k % 2] += -term if k % 4 > 1 else term
        k += 1
        term = term * angle / k
    return DecimalComplex(*parts)


def pinned(one: Any, other: Any, length: float | Decimal, length_2: float | Decimal, branch: int) -> DecimalComplex:
    """The pin at given distances from two points; branch +1: to the left of the line from the first to the second."""
    start, b, c = DecimalComplex.of(one), Decimal(length), Decimal(length_2)
    apart = DecimalComplex.of(other) - start
    along = (apart.square + b * b - c * c) / (2 * apart.square)
    left = branch * (b * b / apart.square - along * along).sqrt()
    return start + apart * DecimalComplex(along, left)


def coupler_point(
    lengths: Sequence[float | Decimal], local: complex, angle: Decimal, branch: int = 1
) -> DecimalComplex:
    """Coupler point at a crank angle, rad, of a four-bar; lengths: ground, crank, coupler, rocker."""
    ground, crank, coupler, rocker = lengths
    pin = circling(crank, angle)
    bar = pinned(pin, ground, coupler, rocker, branch) - pin
    return pin + bar * local * (1 / Decimal(coupler))


def exact(place: Callable[[Decimal], DecimalComplex], angles: Real, rotating: bool = False) -> Array:
    """A place as a function of the crank angle, and its first and second derivative, (3, angles), from decimals.

    If `rotating`, the place is a unit vector, and the imaginary parts of its derivatives are those of its angle.
    """
    found = np.empty((3, len(angles)), dtype=complex)
    with localcontext() as context:
        context.prec = WORKING_DIGITS
        for k, angle in enumerate(map(Decimal, angles.tolist())):
            before, here, after = (place(angle + step) for step in (-STEP, 0, STEP))
            rates = [(after - before) * (1 / (2 * STEP)), (after + before - here * 2) * (1 / STEP**2)]
            rates = [rate * here.conjugate() for rate in rates] if rotating else rates
            found[:, k] = [complex(z.real, z.imag) for z in (here, *rates)]
    return found


def turn() -> Real:
    """Crank angles of a whole turn, rad, (FRAMES,)."""
    return np.arange(FRAMES) * (2 * np.pi / FRAMES)


@record(eq=False)
class Track:
    """A linkage, its crank angles, rad, and the exact values there, (..., frames)."""

    linkage: Any
    drive: Real
    right: Array


def misses(track: Track, found: Any) -> Real:
    """Distance of each value from the exact one; at a frame with several values that of the worst."""
    off: Real = np.abs(np.asarray(found) - track.right).reshape(-1, len(track.drive)).max(axis=0)
    return off


def tables(values: Callable[[Track, Real], Array]) -> tuple[Method, Method]:
    """Methods that interpolate a table of values (..., n), a function of the problem and drives within one turn."""

    def prepare(track: Track, entries: float) -> Array:
        return values(track, np.arange(int(entries)) * (2 * np.pi / int(entries)))

    def interpolated(track: Track, *coefficients: Array) -> Callable[[], Array]:
        """Polynomials between entries, their coefficients by rising powers."""
        count = coefficients[0].shape[-1]

        def call() -> Array:
            place = track.drive * (count / (2 * np.pi))
            k = place.astype(np.intp)
            k, s = k % count, place - k
            found = coefficients[-1][..., k]
            for coefficient in coefficients[-2::-1]:
                found = coefficient[..., k] + s * found
            return found

        return call

    @method("linear table", "entries", ENTRIES, prepared=True)
    def linear(track: Track, entries: float) -> Callable[[], Array]:
        """Values at so many even steps of the crank, prepared beforehand, with linear interpolation."""
        here = prepare(track, entries)
        return interpolated(track, here, np.roll(here, -1, axis=-1) - here)

    @method("cubic table", "entries", ENTRIES, prepared=True)
    def cubic(track: Track, entries: float) -> Callable[[], Array]:
        """The same table with a cubic through the four nearest entries (Lagrange)."""
        here = prepare(track, entries)
        before, ahead, after = (np.roll(here, j, axis=-1) for j in (1, -1, -2))
        two, three = (before + ahead) / 2 - here, (here - ahead) / 2 + (after - before) / 6
        return interpolated(track, here, ahead - here / 2 - before / 3 - after / 6, two, three)

    return linear, cubic


# Digits of the exact answer. The second derivative near a change point loses four digits per digit of distance, and
# more than 50 must remain at a distance of 1e-15.
REFERENCE_DIGITS = 120
# Digits of a double, and those that count as all: a smaller limit would hide a lost digit, a larger one would report
# the rounding of about ten operations as a loss.
WHOLE, ALL = 16.0, 12.5
# Digits by which a result may fall short of what its sizes allow, since its operations round too.
SLACK = 1.7
# Description of the library's behaviour towards the singular position, by the outcomes of `Digits.outcome`.
ANSWERS = {
    "all": "keeps all digits",
    "sizes": "keeps the digits that the sizes allow",
    "all, nan": "keeps all digits, then nan",
    "sizes, nan": "keeps the digits that the sizes allow, then nan",
    "all, refused": "keeps all digits, then refuses",
    "sizes, refused": "keeps the digits that the sizes allow, then refuses",
    "refused": "refuses",
}
Sizes = tuple[float, ...]


@record(eq=False)
class Cell:
    """A result of a family near a singular position: a problem, two methods and the exact answer.

    `sizes` maps a distance, 1e-1 to 1e-15 of the size, which `distance` describes, to the problem's sizes. `formula` is
    the textbook's method, from an mpmath context and the sizes; in 120 digits it is the exact answer. `library` gives
    the same result from this library. `answer` is the expected behaviour, a key of `ANSWERS`; `reported_by` names what
    reports a loss. `amplification` maps the sizes to the factor of errors that the library reports. `share` is the
    relative error of each size: half a last bit, or the accuracy of a search.
    """

    family: str
    place: str
    result: str
    distance: str
    sizes: Callable[[float], Sizes]
    formula: Callable[..., Any]
    library: Callable[..., Any]
    answer: str
    reported_by: str = ""
    amplification: Callable[..., Any] | None = None
    share: float = 2.0**-53

    @property
    def name(self) -> str:
        """Unique name of the cell."""
        return f"{self.family}, {self.place}: {self.result}"


def for_each(results: Sequence[str], cell: Cell) -> tuple[Cell, ...]:
    """A cell for each of several results, of which formula, library and amplification yield the name and the value."""

    def pick(function: Callable[..., Any], result: str, *sizes: Any) -> Any:
        return next(value for name, value in function(*sizes) if name == result)

    def one(result: str) -> Cell:
        formula, library = (partial(pick, function, result) for function in (cell.formula, cell.library))
        amplification = cell.amplification and partial(pick, cell.amplification, result)
        return replace(cell, result=result, formula=formula, library=library, amplification=amplification)

    return tuple(map(one, results))


@record(eq=False)
class Digits:
    """Decimal digits of a cell's result at a distance, 16 at most.

    `library`, `textbook`: digits kept, nan without a number. `allowed`: digits that remain if each size has the cell's
    relative error. `refused`: whether the library raised DesignError. `amplification`: the factor that it reported.
    """

    cell: Cell
    distance: float
    library: float
    textbook: float
    allowed: float
    refused: bool
    amplification: float = np.nan

    @property
    def outcome(self) -> str:
        """all, sizes, nan, refused, or lost: fewer digits than the sizes allow, without notice."""
        if self.refused:
            return "refused"
        if np.isnan(self.library):
            return "nan"
        if self.library >= ALL:
            return "all"
        return "sizes" if self.library >= self.allowed - SLACK else "lost"

    def text(self, kind: str) -> str:
        """Digits of a kind as they are written."""
        value = getattr(self, kind)
        return f"{value:.1f}" if not np.isnan(value) else "refused" if kind == "library" and self.refused else "nan"


def measured_digits(cell: Cell, distance: float) -> Digits:
    """The cell's digits at one distance, compared with arithmetic of 120 digits."""
    try:
        from mpmath import fp, mp
    except ImportError:
        raise DesignError("mpmath", "it is not installed", "pip install mpmath", "file-unreadable") from None

    def digits(off: Any, right: Any) -> float:
        share = abs(off) / abs(right) if right else abs(off)
        return float(min(WHOLE, max(0, -mp.log10(share)))) if share else WHOLE

    def last(values: Any) -> complex:
        # A search near its limit may return nothing on some processors.
        row = np.ravel(values)
        return complex(row[-1]) if row.size else complex(np.nan)

    sizes = cell.sizes(distance)
    with mp.workdps(REFERENCE_DIGITS):
        exact = [mp.mpf(size) for size in sizes]
        right, error = cell.formula(mp, *exact), mp.mpf(0)
        for k, size in enumerate(exact):
            changed = [*exact[:k], size * (1 + mp.mpf(cell.share)), *exact[k + 1 :]]
            error += abs(cell.formula(mp, *changed) - right)
        textbook, library, amplification, refused = np.nan, np.nan, np.nan, False
        try:
            value = mp.mpmathify(cell.formula(fp, *sizes))
            textbook = digits(value - right, right) if mp.isfinite(value) else np.nan
        except (ArithmeticError, ValueError, TypeError):
            pass  # a root of what rounding made negative
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = last(cell.library(*sizes))
                amplification = last(cell.amplification(*sizes)).real if cell.amplification else np.nan
            library = digits(mp.mpmathify(found) - right, right) if np.isfinite(found) else np.nan
        except DesignError:
            refused = True
        return Digits(cell, distance, library, textbook, digits(error, right), refused, amplification)


def answered(found: Sequence[Digits]) -> str:
    """Behaviour of the library at a cell, from its digits by falling distance: a key of `ANSWERS` unless digits are
    lost.
    """
    outcomes = [result.outcome for result in found]
    if "lost" in outcomes:
        return "lost"
    ends = [outcome for outcome in outcomes if outcome in ("nan", "refused")]
    numbers = outcomes[: len(outcomes) - len(ends)]
    if any(number in ("nan", "refused") for number in numbers):
        return "numbers again beyond nan"
    parts = ["sizes" if "sizes" in numbers else "all"] if numbers else []
    return ", ".join([*parts, *ends[-1:]])
