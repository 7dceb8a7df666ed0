"""The unit of length in which a recipe is read, shown and written. Inside, every length is in mm.

A length in a sentence is a value, `f"{mm(length):.4g}"`: it knows its digits, and is written in the reader's unit when
the sentence is shown. Such a text holds marks of private characters; a `Sentence` reads in mm and keeps them.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from math import isfinite
from typing import TYPE_CHECKING, Any, Literal, TypeVar

if TYPE_CHECKING:
    import numpy as np

# Names of the units of length.
Units = Literal["mm", "in"]
Number = TypeVar("Number", float, Any)
# Length of an inch, mm.
INCH = 25.4
# Digits of numbers of a recipe: as many as are exact, so that 0.5 in stays 0.5.
DIGITS = 15
# Significant digits of a recommended number: more than a workshop can set, and short enough for a message.
DIGITS_IN_TEXT = 7

# A thing that is sold in mm keeps them if its size in another unit has more digits.
DIGITS_WITHOUT_MM = 4

# A mark: power of the length, unit, format, text between the numbers, and the numbers.
SPEC = r"(?:up|down)\d?|[,+]?(?:\.\d\d?)?[fg]?"
START, NEXT, END = "\ue000", "\ue001", "\ue002"
MARK = re.compile(
    rf"{START}(-?\d){NEXT}([\w/ ]{{0,20}}){NEXT}({SPEC}){NEXT}([^{START}-{END}]{{0,9}})"
    rf"((?:{NEXT}-?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|inf|nan))*){END}"
)
# In place of a unit: that of length after "in".
PLURAL = "plural"
# Ends of names of entries in summaries that are lengths, areas, volumes or rates of lengths, such as `thickness_mm` and
# `worst_case_mm_per_s`.
SUFFIX = re.compile(r"(?<!_[nN])(?<!_kg)(?<!_per)_mm([23]?)(?=(?:_per_s2?)?$)")
# Entries among lengths that are none.
PURE = ("profile_shift", "tool_profile_shift", "share_of_involute_lost", "time_ratio")
# Entries that hold linkages, whose lengths have the names of their fields.
SOLUTIONS = ("found", "usable", "ranked", "cognates", "trade_off")
LENGTHS = ("ground", "crank", "coupler", "rocker", "offset", "rod", "link", "output", "lever", "shift", "ram_height")


def length_power(unit: str) -> int:
    """Power of the length in a unit: 1 for mm, mm/s2 and kg mm, -1 for 1/mm, 0 for deg."""
    above, _, below = unit.partition("/")
    return sum(
        sign * int(part[2:] or 1)
        for sign, parts in ((1, above), (-1, below))
        for part in parts.split()
        if part.startswith("mm")
    )


def is_mechanical(unit: str) -> bool:
    """Whether a unit is of a force, mass or stress, such as N mm or kg mm2: it stays, whatever the unit of length."""
    return bool(re.search(r"\b(?:N|kg)\b", unit))


def converted_power(unit: str) -> int:
    """Power of the length by which numbers of a unit change with the unit of length."""
    return 0 if is_mechanical(unit) else length_power(unit)


def to_digits(value: float | np.floating[Any], digits: int = 9) -> float:
    """A value rounded to significant digits, as summaries have it; 0 without a sign."""
    return float(f"{value:.{digits}g}") + 0.0


def rounded_up(least: float, digits: int = DIGITS_IN_TEXT) -> str:
    """The smallest number with this many digits that is not below `least`, as text, for remedies."""
    return _rounded(least, digits, ROUND_CEILING)


def rounded_down(most: float, digits: int = DIGITS_IN_TEXT) -> str:
    """The largest number with this many digits that is not above `most`, as text."""
    return _rounded(most, digits, ROUND_FLOOR)


def _rounded(value: float, digits: int, mode: str) -> str:
    # From its decimal text, since the float 0.0072 is a little less than 0.0072.
    return f"{float(Context(digits, mode).create_decimal(Decimal(repr(float(value))))):.{max(digits, 6)}g}"


@dataclasses.dataclass(frozen=True)
class InText:
    """Numbers in a sentence; their format is that of a float, or `up` or `down`: to the safe side of a limit."""

    numbers: tuple[Any, ...]
    unit: str
    power: int
    between: str = ""

    def __format__(self, spec: str) -> str:
        if not re.fullmatch(SPEC, spec):
            raise ValueError(f"format {spec!r} of a length in a sentence")
        numbers = (repr(n if isinstance(n, int) else float(n)) for n in self.numbers)
        return f"{START}{NEXT.join((str(self.power), self.unit, spec, self.between, *numbers))}{END}"


def mm(*numbers: Any, unit: str = "mm", between: str = ", ") -> InText:
    """Numbers of a unit with mm, for a sentence, with their unit: `f"{mm(3, 4, between=' x '):g}"` is `3 x 4 mm`."""
    return InText(numbers, unit, converted_power(unit), between)


def bare_mm(*numbers: Any, power: int = 1) -> InText:
    """The same without the unit, which another place of the sentence states."""
    return InText(numbers, "", power, ", ")


def unit_name(unit: str = "mm") -> str:
    """The name of a unit with mm, for a sentence."""
    return f"{InText((), unit, 0)}"


def _written(number: str, factor: float, spec: str) -> str:
    """A number of a sentence, divided by the factor, in its format."""
    if factor == 1 and not spec:
        return number
    value = float(number) if factor == 1 else to_digits(float(number) / factor, 12)
    if rounding := re.fullmatch(r"(up|down)(\d?)", spec):
        digits = int(rounding[2] or DIGITS_IN_TEXT)
        if not isfinite(value):
            return f"{value:g}"
        return (rounded_up if rounding[1] == "up" else rounded_down)(value, digits)
    if factor != 1 and spec.endswith("f"):
        # An inch has 25.4 mm, so it needs more decimals.
        start, _, decimals = spec[:-1].partition(".")
        return f"{value:{start}.{int(decimals or 6) + 2}f}".rstrip("0").rstrip(".")
    return f"{value:{spec or '.12g'}}"


@dataclasses.dataclass(frozen=True)
class LengthUnit:
    """A unit of length: its name, and how many mm it has.

    Units of lengths, angles and times change with it, such as mm, mm2, mm/s and 1/mm. Forces, masses, torques,
    stiffnesses and stresses stay in N, kg, N mm, N/mm and N/mm2.
    """

    name: Units
    mm: float

    @property
    def plural(self) -> str:
        """The unit in a sentence."""
        return "inches" if self.name == "in" else self.name

    def factor(self, unit: str) -> float:
        """By what a number of a unit with mm is divided to be one of this unit."""
        return self.mm ** converted_power(unit)

    def of(self, value: Number, unit: str = "mm") -> Number:
        """A value, given in a unit with mm, in this unit."""
        factor = self.factor(unit)
        return value if factor == 1 else value / factor

    def in_digits(self, value: float, unit: str) -> float | int:
        """The same with as few digits as give this value when a recipe is read; a whole number stays one."""
        factor = self.factor(unit)
        if factor == 1:
            return value
        candidates = [to_digits(value / factor, digits) for digits in range(DIGITS - 1, DIGITS + 3)]
        return next((one for one in candidates if to_digits(one * factor, DIGITS) == value), candidates[1])

    def in_mm(self, value: float, unit: str) -> float | int:
        """The reverse: a number of a recipe in this unit, in the unit with mm."""
        factor = self.factor(unit)
        return value if factor == 1 else to_digits(value * factor, DIGITS)

    def unit(self, unit: str) -> str:
        """The name of a unit with mm, such as in/s for mm/s."""
        return unit if self.factor(unit) == 1 else re.sub(r"\bmm", self.name, unit)

    def text(self, text: str, keeps_mm: bool = False) -> str:
        """A sentence with its lengths in this unit.

        Parameters
        ----------
        text : str
            The sentence.
        keeps_mm : bool
            Whether a length that is round in mm only keeps that too, as for things that are sold in mm.
        """

        def written(match: re.Match[str]) -> str:
            power, unit, spec, between, numbers = match.groups()
            name = self.plural if unit == PLURAL else self.unit(unit)

            def in_unit(factor: float, spec: str) -> str:
                texts = [_written(number, factor, spec) for number in numbers.split(NEXT)[1:]]
                # A range whose ends are written alike is one number.
                return between.join(dict.fromkeys(texts) if between == " to " else texts)

            factor = self.mm ** int(power)
            text = f"{in_unit(factor, spec)} {name}".strip()
            if keeps_mm and factor != 1 and unit and numbers:
                values = [float(number) / factor for number in numbers.split(NEXT)[1:]]
                if any(abs(to_digits(value, DIGITS_WITHOUT_MM) - value) > 1e-9 * abs(value) for value in values):
                    # A least length is rounded up in both units.
                    side = re.match("up|down", spec)
                    rough = f"{side[0]}{DIGITS_WITHOUT_MM}" if side else ".3g"
                    return f"{in_unit(1, spec)} {unit} ({in_unit(factor, rough)} {name})"
            return text

        return MARK.sub(written, marked(text))

    def entries(self, data: Any, power: int = 0, lengths: Collection[str] = ()) -> Any:
        """Entries of a summary, and their names such as `thickness_mm`, in this unit.

        power: of the length in numbers without a unit in their name. lengths: names of entries that are lengths.
        """
        if isinstance(data, Mapping):
            return {
                SUFFIX.sub(rf"_{self.name}\1", name): self.entries(value, *self._kind(name, power, lengths))
                for name, value in data.items()
            }
        if isinstance(data, list | tuple):
            return [self.entries(item, power, lengths) for item in data]
        if isinstance(data, str):
            return self.text(data, keeps_mm=True)
        return to_digits(data / self.mm**power, 10) if self.mm != 1 and power and isinstance(data, float) else data

    def _kind(self, name: str, power: int, lengths: Collection[str]) -> tuple[int, Collection[str]]:
        """Arguments of `entries` for the entry of a name."""
        lengths = LENGTHS if name in SOLUTIONS else lengths
        if match := SUFFIX.search(name):
            return int(match[1] or 1), lengths
        if name.endswith("_deg") or name in PURE:
            return 0, lengths
        return power or (name in lengths), lengths


MM, IN = LengthUnit("mm", 1.0), LengthUnit("in", INCH)
UNITS: Mapping[str, LengthUnit] = {"mm": MM, "in": IN}


class Sentence(str):
    """A text that reads in mm, and knows its lengths, so that a recipe in inches writes them in inches.

    Parameters
    ----------
    text : str
        The text, with its marks.
    change : callable, optional
        Changes the words between the marks.
    """

    marked: str

    def __new__(cls, text: str, change: Callable[[str], str] = str) -> Sentence:
        text = marked(text)
        if change is not str:
            ends = [0, *(end for match in MARK.finditer(text) for end in match.span()), len(text)]
            pieces = [text[start:end] for start, end in zip(ends, ends[1:])]
            text = "".join(piece if k % 2 else change(piece) for k, piece in enumerate(pieces))
        sentence = super().__new__(cls, MM.text(text) if START in text else text)
        sentence.marked = text
        return sentence

    def __getnewargs__(self) -> tuple[str]:
        return (self.marked,)


def marked(text: object) -> str:
    """A text with the marks of its lengths, to be part of another sentence."""
    return text.marked if isinstance(text, Sentence) else str(text)


def in_sentences(value: Any) -> Any:
    """A text, or the texts in a table or a row, as sentences."""
    if isinstance(value, str):
        return Sentence(value) if START in value else value
    if isinstance(value, Mapping):
        return {name: in_sentences(item) for name, item in value.items()}
    return type(value)(map(in_sentences, value)) if type(value) in (list, tuple) else value


def sentences(texts: Iterable[str]) -> tuple[Sentence, ...]:
    """The texts as sentences."""
    return tuple(map(Sentence, texts))


def as_sentences(thing: Any, *fields: str) -> None:
    """Make texts of a frozen dataclass sentences, as its `__post_init__` does."""
    for name in fields:
        object.__setattr__(thing, name, Sentence(getattr(thing, name)))
