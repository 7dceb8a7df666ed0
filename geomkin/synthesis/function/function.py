"""What a search for function generators returns."""

from __future__ import annotations

import contextlib
from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from typing import Annotated, Any, Literal, NamedTuple, Self, TypeVar

import numpy as np

from ...core.arguments import ArgumentType, Count, Reals, are_reals, between, checked, is_real, is_whole, numbers
from ...core.errors import DesignError
from ...core.fields import FARTHEST, SMALLEST, Size, rounded_down
from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Real
from ..found import Found, ten_digits
from ..rounding import Rounding
from .generators import DECIMALS, AbstractGenerator, FourBarGenerator, SliderGenerator
from .minimax import certified
from .search import EXACT, KEPT, LOOKS, PEAKS, Optimum, peaks, searched
from .wanted import Function, WantedFunction, wanted_function

DEGREE = float(np.degrees(1.0))


class Peak(NamedTuple):
    """A place where the error is largest between its neighbours.

    error: deg of the output, or mm of the slider: what is reached less what is wanted. multiplier: the share that it
    has in holding the largest error where it is, all shares 1; 0 where it could grow, nan where no minimax was asked.
    """

    x: float
    error: float
    multiplier: float


@record(eq=False, kw_only=True)
class AbstractFunctionGenerator(Found):
    """What function generators have in common.

    alternation: the error's peaks, in order of x. active_limits: of "transmission angle" and "ratio" those that hold
    the error up, with their multipliers: how fast the largest error would fall, in its unit, were the limit moved (the
    cosine of the transmission angle, the logarithm of the ratio). certificate: what is left of the derivatives of the
    error at the peaks and of the active limits, each times its multiplier: 0 to rounding, as no multiplier is negative,
    proves that no small change of the sizes makes all peaks less; nan for least squares. others: what the
    search found besides, the best first.
    """

    alternation: tuple[Peak, ...]
    active_limits: Mapping[str, float]
    certificate: float
    others: tuple[Self, ...] = ()
    wanted: WantedFunction = field(repr=False)
    task: AbstractGenerator = field(repr=False)
    unknowns: Real = field(repr=False)

    @property
    @abstractmethod
    def _output(self) -> tuple[float, float]:
        """Where the wanted output starts, and how far it goes: deg or mm."""

    @property
    @abstractmethod
    def _unit(self) -> float:
        """Of the task's errors, deg or mm."""

    def _error(self, s: Real) -> Real:
        """Errors (1, m), deg or mm, at shares (1, m) of the input's way."""
        return self._unit * self.task.error(self.unknowns[None], s)

    def _with(self, linkage: AbstractLinkage, p: Real) -> Self:
        """The same with other unknowns p (unknowns,); multipliers and certificate remain those of the optimum."""
        at, errors, real = (row[0] for row in peaks(self.task, p[None], PEAKS, LOOKS))
        x, errors = self.wanted.x(at[real]).tolist(), (self._unit * errors[real]).tolist()
        same = len(x) == len(self.alternation)
        multipliers = [peak.multiplier for peak in self.alternation] if same else len(x) * [np.nan]
        return replace(
            self,
            linkage=linkage,
            drive=p[3] + np.array([0.0, self.task.swing]),
            transmission_angle_deg=float(np.degrees(self.task.transmission(p[None])[0])),
            alternation=tuple(map(Peak, x, errors, multipliers)),
            unknowns=p,
        )

    @property
    def largest(self) -> float:
        """The largest error of the output, deg or mm."""
        return max(abs(peak.error) for peak in self.alternation)

    def proof(self) -> Mapping[str, object]:
        """As `summary.json` lists it: the error's peaks, deg or mm, and the active limits, with their multipliers."""
        # A top is flat: half of all digits tell its place.
        peaks = [{name: _six(value) for name, value in peak._asdict().items()} for peak in self.alternation]
        return {
            "alternation": peaks,
            "active_limits": {name: _six(value) for name, value in self.active_limits.items()},
        }

    def _share(self, x: Reals) -> Real:
        """Of the input's way, (...,)."""
        return np.asarray((np.asarray(x, dtype=float) - self.wanted.x0) / (self.wanted.x1 - self.wanted.x0))

    @checked
    def input_at(self, x: Reals) -> Real:
        """Angle of the input (...,) at x (...,), rad from the ground line."""
        return np.asarray(self.drive[0] + (self.drive[1] - self.drive[0]) * self._share(x))

    @checked
    def wanted_at(self, x: Reals) -> Real:
        """What is wanted of the output (...,) at x (...,): deg from the ground line, or mm along the slide line."""
        start, way = self._output
        return np.asarray(start + way * self.wanted.share(self._share(x)))

    @checked
    def error(self, x: Reals) -> Real:
        """The output's error (...,) at x (...,), deg or mm: reached less wanted; nan where the linkage is open."""
        s = self._share(x)
        return self._error(s.reshape(1, -1)).reshape(s.shape)


@record(eq=False, kw_only=True)
class FunctionGenerator(AbstractFunctionGenerator):
    """A four-bar whose rocker follows a function of its crank's angle.

    starts_deg: of input and output, from the ground line, the rocker's direction from its ground pivot; there stand x0
    and y(x0) on their scales. largest_error_deg: of the output angle, also between any samples.
    """

    linkage: FourBar
    starts_deg: tuple[float, float]
    largest_error_deg: float
    task: FourBarGenerator = field(repr=False)

    @property
    def _output(self) -> tuple[float, float]:
        return self.starts_deg[1], DEGREE * self.task.out

    @property
    def _unit(self) -> float:
        return DEGREE

    def rounded(self, rounding: Rounding) -> FunctionGenerator:
        linkage = rounding.linkage(self.linkage)
        first, last = (rounding.angle(f"{end}_start_deg", at) for end, at in zip(("input", "output"), self.starts_deg))
        logs = np.log(np.array([linkage.crank, linkage.coupler, linkage.rocker]) / linkage.ground)
        other = self._with(linkage, np.array([*logs, *np.radians([first, last]), self.branch]))
        return replace(other, starts_deg=(first, last), largest_error_deg=other.largest)

    def summary(self) -> Mapping[str, object]:
        starts = [ten_digits(start) for start in self.starts_deg]
        return {"largest_error_deg": ten_digits(self.largest_error_deg), "starts_deg": starts, **super().summary()}


@record(eq=False, kw_only=True)
class SliderFunctionGenerator(AbstractFunctionGenerator):
    """A slider-crank whose slider follows a function of its crank's angle.

    start_deg: of the crank, from the slide line; start_mm: the slider's place for y(x0), along that line from the foot
    of the crank pivot. largest_error: of the slider's place, mm, also between any samples.
    """

    linkage: SliderCrank
    start_deg: float
    start_mm: float
    largest_error: float
    task: SliderGenerator = field(repr=False)

    @property
    def _output(self) -> tuple[float, float]:
        return self.start_mm, self.task.sense * self.task.length

    @property
    def _unit(self) -> float:
        return self.task.length

    def rounded(self, rounding: Rounding) -> SliderFunctionGenerator:
        linkage, way = rounding.linkage(self.linkage), self.task.length
        first = rounding.angle("input_start_deg", self.start_deg)
        place = rounding.length("output_start_mm", self.start_mm)
        logs = np.log(np.array([linkage.crank, linkage.coupler]) / way)
        p = np.array([*logs, float(linkage.offset) / way, np.radians(first), place / way, self.branch])
        other = self._with(linkage, p)
        return replace(other, start_deg=first, start_mm=place, largest_error=other.largest)

    def summary(self) -> Mapping[str, object]:
        told = {"largest_error_mm": self.largest_error, "start_deg": self.start_deg, "start_mm": self.start_mm}
        return {**{name: ten_digits(value) for name, value in told.items()}, **super().summary()}


def _six(value: float) -> float | None:
    """Six digits of a number; None for what cannot be told."""
    return float(f"{value:.6g}") if np.isfinite(value) else None


G = TypeVar("G", bound=AbstractFunctionGenerator)
Method = Literal["minimax", "least-squares", "points"]


def _from_to(least: float, most: float, unit: str) -> ArgumentType:
    """Of a number whose size is so much, and whose sign tells the sense."""
    allowed = f"a number from {least:g} to {most:g}, or its negative, in {unit}"
    return ArgumentType(lambda value: is_real(value) and least <= abs(value) <= most, allowed)


def _are_points(value: Any) -> bool:
    if is_whole(value):
        return bool(3 <= value <= 5)
    row = numbers(value, "iuf")
    return row is not None and row.ndim == 1 and 3 <= len(row) <= 5 and are_reals(row)


# Less than a tenth of a degree tells nothing of a function; a whole turn ends where it began.
Swing = Annotated[float, _from_to(0.1, 359, "deg")]
Way = Annotated[float, _from_to(SMALLEST, FARTHEST, "mm")]
Start = Annotated[float, between(-360, 360, "deg")]
Place = Annotated[float, between(-FARTHEST, FARTHEST, "mm")]
# Without these two limits many functions have no best linkage: it runs to a toggle, or to links without end.
Transmission = Annotated[float, between(5, 85, "deg")]
Ratio = Annotated[float, between(1.1, 100)]
Points = Annotated[int | Sequence[float], ArgumentType(_are_points, "3, 4 or 5, or a row of so many places x")]


@checked
def function_generator(
    function: Function,
    span: tuple[float, float],
    input_deg: Swing = 60.0,
    output_deg: Swing = 90.0,
    input_start_deg: Start | None = None,
    output_start_deg: Start | None = None,
    least_transmission_angle_deg: Transmission = 30.0,
    largest_ratio: Ratio = 10.0,
    method: Method = "minimax",
    points: Points = 3,
    ground: Size = 100.0,
) -> FunctionGenerator:
    """The four-bar whose rocker follows y = function(x) as its crank goes over x from x0 to x1, the span.

    The input angle is its start + input_deg (x - x0)/(x1 - x0), the output angle its start + output_deg
    (y - y(x0))/(y(x1) - y(x0)), from the ground line, counterclockwise; starts that are not given are found. function:
    of a number or an array; or a text such as `log10(x)` (see `Expression`; angles are rad); or rows (x, y), with a
    cubic spline through them. method: "minimax", the least largest error of the output angle; "least-squares", its
    least mean square; "points", none at so many precision points, 3 to 5: Chebyshev's, or those given as x; what they
    leave free makes the largest error least. 3 of them need no free start, 4 one, 5 both. No link is longer than
    largest_ratio times another, and the transmission angle keeps its limit over the whole way. ground, mm.

    Derived here: fits of Freudenstein's equation over a grid of start angles, and sizes spread over what the limits
    allow, are scored by their true error; the best few dozen are followed to their optima. `others` are those that are
    not the best. DesignError for a function with a pole, or with two equal ends, and where no linkage keeps the limits.
    """
    wanted = wanted_function(function, span)
    _refuse_turns(wanted, float(output_deg))
    task = FourBarGenerator(
        share=wanted.share,
        swing=float(np.radians(input_deg)),
        starts=(_given(input_start_deg, DEGREE), _given(output_start_deg, DEGREE)),
        least_transmission=float(np.radians(least_transmission_angle_deg)),
        largest_ratio=float(largest_ratio),
        through=_through(wanted, method, points, (input_start_deg, output_start_deg)),
        out=float(np.radians(output_deg)),
        ground=float(ground),
    )

    def made(optimum: Optimum) -> FunctionGenerator:
        starts = [
            _within_half_turn(found) if given is None else float(given)
            for found, given in zip(np.degrees(optimum.p[3:5]).tolist(), (input_start_deg, output_start_deg))
        ]
        return FunctionGenerator(
            **_told(task, wanted, optimum, method, DEGREE, starts[0]),
            starts_deg=(starts[0], starts[1]),
            largest_error_deg=DEGREE * optimum.worst,
            task=task,
        )

    return _best(task, method, made)


@checked
def slider_function_generator(
    function: Function,
    span: tuple[float, float],
    input_deg: Swing = 60.0,
    output_mm: Way = 50.0,
    input_start_deg: Start | None = None,
    output_start_mm: Place | None = None,
    least_transmission_angle_deg: Transmission = 30.0,
    largest_ratio: Ratio = 10.0,
    method: Method = "minimax",
    points: Points = 3,
) -> SliderFunctionGenerator:
    """The slider-crank whose slider follows y = function(x) as its crank goes over x from x0 to x1, the span.

    As `function_generator`, with the slider's place along its line for the output: its start + output_mm
    (y - y(x0))/(y(x1) - y(x0)), mm along +x from the foot of the crank pivot. The transmission angle is that between
    the connecting rod and the normal of the slide line; the ratio is that of crank and rod.
    """
    wanted = wanted_function(function, span)
    length = abs(float(output_mm))
    task = SliderGenerator(
        share=wanted.share,
        swing=float(np.radians(input_deg)),
        starts=(_given(input_start_deg, DEGREE), _given(output_start_mm, length)),
        least_transmission=float(np.radians(least_transmission_angle_deg)),
        largest_ratio=float(largest_ratio),
        through=_through(wanted, method, points, (input_start_deg, output_start_mm)),
        sense=float(np.sign(output_mm)),
        length=length,
    )

    def made(optimum: Optimum) -> SliderFunctionGenerator:
        first = float(np.degrees(optimum.p[3]))
        start = _within_half_turn(first) if input_start_deg is None else float(input_start_deg)
        return SliderFunctionGenerator(
            **_told(task, wanted, optimum, method, length, start),
            start_deg=start,
            start_mm=length * float(optimum.p[4]) if output_start_mm is None else float(output_start_mm),
            largest_error=length * optimum.worst,
            task=task,
        )

    return _best(task, method, made)


def _given(start: float | None, unit: float) -> float:
    """In the unit of the unknowns; nan where it is free."""
    return np.nan if start is None else float(start) / unit


def _within_half_turn(degrees: float) -> float:
    return round(degrees - 360 * float(np.ceil(degrees / 360 - 0.5)), DECIMALS)


def _refuse_turns(wanted: WantedFunction, output_deg: float) -> None:
    """What goes over a turn on its way from one end to the other, no rocker follows."""
    shares = wanted.share(np.linspace(0, 1, 1025))
    turn = abs(output_deg) * float(np.ptp(shares))
    if turn > 359:
        raise DesignError(
            "output_deg",
            f"found {output_deg:g}, with which the output would go {turn:.6g} deg between its farthest places",
            f"give at most {rounded_down(359 / float(np.ptp(shares)), 4)} deg, or a range in which it rises or falls",
        )


def _through(
    wanted: WantedFunction, method: str, points: int | Sequence[float], starts: tuple[float | None, float | None]
) -> tuple[float, ...]:
    """The precision points as shares of the input's way; none for other methods."""
    if method != "points":
        return ()
    x = chebyshev_points((wanted.x0, wanted.x1), points) if is_whole(points) else np.asarray(points, dtype=float)  # type: ignore[arg-type]
    most = 3 + starts.count(None)
    if len(x) > most:
        raise DesignError(
            "points",
            f"found {len(x)}, but three lengths and the free starts meet only {most}",
            "give no start, or fewer points",
        )
    shares = (x - wanted.x0) / (wanted.x1 - wanted.x0)
    if not ((shares >= 0) & (shares <= 1)).all() or (np.diff(shares) < 1e-3).any():
        raise DesignError(
            "points",
            f"found {', '.join(f'{one:g}' for one in x)}",
            f"give rising places from {wanted.x0:g} to {wanted.x1:g}, a thousandth of that apart and more",
        )
    return tuple(shares.tolist())


def _best(task: AbstractGenerator, method: str, made: Callable[[Optimum], G]) -> G:
    """The best of the optima that are found, and with it the others."""
    squares = method == "least-squares"
    optima = searched(task, squares)
    if not optima:
        raise DesignError("input_start_deg", "no linkage was found that closes from these starts", "leave a start free")
    best = optima[0]
    if best.broken > KEPT or not np.isfinite(best.worst):
        # With the least angle there is, to tell whether it is the angle that is in the way.
        looser = [
            one for one in searched(replace(task, least_transmission=np.radians(5)), squares) if one.broken <= KEPT
        ]
        if looser:
            angle = float(np.degrees(task.transmission(np.stack([one.p for one in looser])).max()))
            least = float(np.degrees(task.least_transmission))
            raise DesignError(
                "least_transmission_angle_deg",
                f"found {least:g}, which no linkage kept that was tried",
                f"give at most {rounded_down(angle, 3)}, leave starts free, or give other swings",
            )
        if task.through and np.abs(task.error(best.p[None], np.array(task.through)[None])).max() > KEPT:
            raise DesignError(
                "points",
                f"no linkage was found that meets these {len(task.through)} within the limits",
                "give fewer or others, leave starts free, or give other swings or limits",
            )
        raise DesignError(
            "largest_ratio",
            f"found {task.largest_ratio:g}, but no linkage that was tried does what is asked within the limits",
            "give a larger one or a smaller least transmission angle, leave starts free, or give other swings",
        )
    others = []
    for optimum in optima[1:]:
        # One whose links are longer than any may be is left out.
        with contextlib.suppress(DesignError):
            others.append(made(optimum))
    return replace(made(best), others=tuple(others))


def _told(
    task: AbstractGenerator, wanted: WantedFunction, optimum: Optimum, method: str, unit: float, start_deg: float
) -> dict[str, Any]:
    """What both results have in common."""
    s, errors = optimum.s, optimum.errors
    multipliers, limits, left = np.full(len(s), np.nan), dict[str, float](), np.nan
    if optimum.worst < EXACT:
        left = 0.0
    elif method != "least-squares":
        proof = certified(task, optimum.p, s, errors)
        multipliers, left = proof.peaks, proof.left
        for name, value in zip(task.limit_names, proof.limits):
            if value > 0 and name:
                limits[name] = limits.get(name, 0.0) + unit * float(value)
    return {
        "linkage": task.linkage(optimum.p),
        "branch": int(optimum.p[5]),
        "drive": np.radians(start_deg) + np.array([0.0, task.swing]),
        "transmission_angle_deg": float(np.degrees(task.transmission(optimum.p[None])[0])),
        "alternation": tuple(
            Peak(*one) for one in zip(wanted.x(s).tolist(), (unit * errors).tolist(), multipliers.tolist())
        ),
        "active_limits": limits,
        "certificate": left,
        "wanted": wanted,
        "unknowns": optimum.p,
    }


@checked
def chebyshev_points(span: tuple[float, float], count: Count = 3) -> Real:
    """Chebyshev's spacing of precision points from x0 to x1, (count,), rising.

    x = (x0 + x1)/2 - (x1 - x0)/2 cos((2 k - 1) pi/(2 count)), k = 1, 2, ...: the zeros of the polynomial of this degree
    that stays nearest to nothing over the range; an error with these zeros has nearly equal peaks (Hartenberg and
    Denavit, Kinematic Synthesis of Linkages, 1964, chapter 5). 1 to 3 with 3: 1.134, 2, 2.866.
    """
    x0, x1 = (float(x) for x in span)
    if not x0 < x1:
        raise DesignError("span", f"found {x0:g} to {x1:g}", "give a rising pair")
    if count > 100:
        raise DesignError("count", f"found {count}", "give at most 100")
    found: Real = 0.5 * (x0 + x1) - 0.5 * (x1 - x0) * np.cos((np.arange(count) + 0.5) * np.pi / count)
    return found
