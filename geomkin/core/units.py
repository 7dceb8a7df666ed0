"""The unit of length in which a recipe is read, shown and written. Inside, every length is in mm."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Collection, Mapping
from typing import Any, Literal, TypeVar

from .errors import Problem
from .fields import rounded_down, rounded_up, to_digits

# Names of the units of length.
Units = Literal["mm", "in"]
Number = TypeVar("Number", float, Any)
# Length of an inch, mm.
INCH = 25.4
# Digits of numbers of a recipe: as many as are exact, so that 0.5 in stays 0.5.
DIGITS = 15
# Digits of numbers in sentences, and in those on problems, whose numbers may be close to a limit.
DIGITS_IN_TEXT, DIGITS_IN_PROBLEM = 5, 7

NUMBER = r"[-+]?(?:\d+(?:,\d{3})*(?:\.\d+)?|\.\d+)(?:e[-+]?\d+)?"
# Numbers of one unit in a row, such as `3 x 4 mm`, `3 to 4 mm` or `(3, 4) mm`; a name such as M3 or #6-32 is none.
BETWEEN = r"(?:,? (?:x|\u00d7|to|(?:and|or)(?: (?:less|more) than| at (?:least|most))?) |, )"
IN_MM = re.compile(rf"(?<![\w#.-])((?:{NUMBER}{BETWEEN})*{NUMBER}\)?) (mm[23]?(?:/(?:s|rad|deg)[23]?)?)\b")
# The same, or a number without a unit before the end of a clause.
ALSO_BARE = re.compile(
    rf"{IN_MM.pattern}|(?<![\w#./-])({NUMBER})(?=$|[,;:)\]]|\.$| \(| (?:and|to|or|x|for|with|in mm|in a row)\b)"
)
ONE = re.compile(rf"({NUMBER})")
# What the user wrote: a text, or a table in place of a number, whose numbers are not read.
QUOTED = re.compile(r"((?<!\w)'[^']*'(?!\w)|\{.*\})")
SCALE = re.compile(rf"1 mm is ({NUMBER}) ")
# Ends of names of entries in summaries that are lengths, areas, volumes or rates of lengths, such as `thickness_mm` and
# `worst_case_mm_per_s`.
SUFFIX = re.compile(r"(?<!_[nN])(?<!_kg)(?<!_per)_mm([23]?)(?=(?:_per_s2?)?$)")
# Entries among lengths that are none.
PURE = ("profile_shift",)
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
        return 1.0 if is_mechanical(unit) else self.mm ** length_power(unit)

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

    def text(self, text: str, is_length: bool = False, keeps_mm: bool = False, digits: int = DIGITS_IN_TEXT) -> str:
        """A sentence whose lengths in mm, except those in quotes, are in this unit.

        Parameters
        ----------
        text : str
            The sentence.
        is_length : bool
            Whether numbers without a unit are lengths too, as in the message about a length.
        keeps_mm : bool
            Whether a length that is round in mm only keeps that too, as for things that are sold in mm.
        digits : int
            Significant digits of numbers.
        """
        if self.mm == 1:
            return text

        def with_unit(match: re.Match[str]) -> str:
            numbers, unit = match[1], match[2]
            ahead = match.string[: match.start()]
            if not numbers:
                return self._number(ahead, match[0], "mm", digits)
            converted = ONE.sub(lambda one: self._number(ahead + numbers[: one.start()], one[0], unit, digits), numbers)
            if keeps_mm and any(len(one.lstrip("0.")) > 4 for one in ONE.findall(converted)):
                return (
                    f"{match[0]} ({ONE.sub(lambda one: f'{self.of(_value(one[0]), unit):.3g}', numbers)} {self.name})"
                )
            return f"{converted} {self.unit(unit)}"

        # A drawing that is 25.4 times as large; the quantity itself is converted below.
        text = SCALE.sub(lambda match: f"1 {self.name} is {to_digits(self.mm * float(match[1]), 3):g} ", text)
        lengths = ALSO_BARE if is_length else IN_MM
        text = "".join(part if k % 2 else lengths.sub(with_unit, part) for k, part in enumerate(QUOTED.split(text)))
        return re.sub(r"\bin mm\b", f"in {self.plural}", text) if is_length else text

    def problem(self, problem: Problem, is_length: bool) -> Problem:
        """A problem of a recipe; is_length: whether that of a length."""
        problem_text, remedy = (
            self.text(text, is_length, digits=DIGITS_IN_PROBLEM) for text in (problem.problem, problem.remedy)
        )
        value = problem.value if problem.value is None or not is_length else self.in_digits(problem.value, "mm")
        return dataclasses.replace(problem, problem=problem_text, remedy=remedy, value=value)

    def entries(self, data: Any, power: int = 0, lengths: Collection[str] = ()) -> Any:
        """Entries of a summary, and their names such as `thickness_mm`, in this unit.

        power: of the length in numbers without a unit in their name. lengths: names of entries that are lengths.
        """
        if self.mm == 1:
            return data
        if isinstance(data, Mapping):
            return {
                SUFFIX.sub(rf"_{self.name}\1", name): self.entries(value, *self._kind(name, power, lengths))
                for name, value in data.items()
            }
        if isinstance(data, list | tuple):
            return [self.entries(item, power, lengths) for item in data]
        if isinstance(data, str):
            return self.text(data, keeps_mm=True)
        return to_digits(data / self.mm**power, 10) if power and isinstance(data, float) else data

    def _kind(self, name: str, power: int, lengths: Collection[str]) -> tuple[int, Collection[str]]:
        """Arguments of `entries` for the entry of a name."""
        lengths = LENGTHS if name in SOLUTIONS else lengths
        if match := SUFFIX.search(name):
            return int(match[1] or 1), lengths
        if name.endswith("_deg") or name in PURE:
            return 0, lengths
        return power or (name in lengths), lengths

    def _number(self, ahead: str, number: str, unit: str, digits: int) -> str:
        """A number in this unit; as a limit, by the words ahead of it, rounded so that it is allowed."""
        value = to_digits(_value(number) / self.factor(unit), 12)
        if ahead.endswith(("at least ", "more than ", "above ")):
            return rounded_up(value, digits)
        if ahead.endswith(("at most ", "less than ", "below ")):
            return rounded_down(value, digits)
        return f"{value:.{digits}g}"


MM, IN = LengthUnit("mm", 1.0), LengthUnit("in", INCH)
UNITS: Mapping[str, LengthUnit] = {"mm": MM, "in": IN}


def _value(number: str) -> float:
    return float(number.replace(",", ""))
