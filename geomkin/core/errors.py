"""What can go wrong, as types: every message says what was found, what is allowed and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

# The kinds of refusal. A program may rely on them: their texts may change, these do not.
ProblemId = Literal[
    "unknown-key",
    "missing-key",
    "unknown-kind",
    "wrong-type",
    "out-of-range",
    "not-finite",
    "conflict",  # two values that do not go together, each by itself allowed
    "impossible-geometry",  # no such mechanism exists; also what nothing more specific applies to
    "does-not-assemble",
    "too-much-work",
    "invalid-toml",
    "file-unreadable",
    "file-unwritable",
    "internal",  # a fault of geomkin
]


class GeomkinError(Exception):
    """Anything geomkin refuses to do. Its text is meant for a person, without a traceback."""


class DesignError(GeomkinError, ValueError):
    """A mechanism that cannot exist as asked.

    Parameters
    ----------
    field : str
        The size that is wrong, as its class spells it.
    problem : str
        What was found.
    remedy : str
        What is allowed, or what to change.
    id : str
        The kind of refusal, one of `ProblemId`.
    """

    def __init__(self, field: str, problem: str, remedy: str, id: ProblemId = "impossible-geometry"):
        field, problem, remedy = harmless(field), harmless(problem), harmless(remedy)
        super().__init__(f"{field}: {problem}; {remedy}")
        self.field, self.problem, self.remedy, self.id = field, problem, remedy, id

    def __reduce__(self) -> tuple[Any, ...]:
        # An exception is pickled as its class and its text, which this one is not made from.
        return type(self), (self.field, self.problem, self.remedy, self.id), self.__dict__


@dataclass(frozen=True)
class Problem:
    """One thing wrong in a recipe.

    Parameters
    ----------
    key : str
        Dotted, as in `linkage.crank`; "" for the whole file.
    problem, remedy : str
        What was found, and what to change.
    id : str
        The kind of refusal, one of `ProblemId`.
    """

    key: str
    problem: str
    remedy: str
    id: ProblemId = "impossible-geometry"

    def __repr__(self) -> str:
        return printable(f"Problem({self})", 120)

    def __str__(self) -> str:
        return harmless(f"{self.key or '(whole file)'}: {self.problem}; {self.remedy}")


# Problems told of one recipe: more push the first, mostly the cause of the rest, out of sight.
TOLD = 20


class RecipeError(GeomkinError, ValueError):
    """A recipe that cannot be read or made: all its problems at once, each with its key; the text tells the first."""

    def __init__(self, file: str, problems: list[Problem]):
        lines = [f"{printable(file)}: {p}" for p in problems[:TOLD]]
        if len(problems) > TOLD:
            lines.append(f"{printable(file)}: and {len(problems) - TOLD:,} more problems; mend these first")
        super().__init__("\n".join(lines))
        self.file, self.problems = file, tuple(problems)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.file, list(self.problems)), self.__dict__


class FileError(GeomkinError, OSError):
    """A file that could not be read or written; the file that had its name before is unchanged.

    Parameters
    ----------
    file : str or path
    problem, remedy : str
        What went wrong, and what to change.
    id : {"file-unreadable", "file-unwritable"}
    """

    def __init__(self, file: object, problem: str, remedy: str, id: ProblemId):
        self.file, self.problem, self.remedy, self.id = printable(file), harmless(problem), harmless(remedy), id
        super().__init__(f"{self.file}: {self.problem}; {self.remedy}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.file, self.problem, self.remedy, self.id), self.__dict__


def harmless(text: object) -> str:
    """`text` as one line without the control characters that a terminal would obey and the marks it would turn by."""
    return "".join(c if c.isprintable() else "?" for c in str(text))


def printable(text: object, longest: int = 80) -> str:
    """`text` as one line fit for a terminal: no control characters, no more than `longest` characters.

    A longer one loses its middle, since a path is known by its two ends.
    """
    line = harmless(text)
    return line if len(line) <= longest else f"{line[: longest // 2]}...{line[-(longest // 2 - 3) :]}"


def shown(value: object) -> str:
    """A value as its author would recognise it, on one line of bearable length, whatever it is."""
    try:
        return printable(repr(value))
    except (ValueError, RecursionError):
        return f"a {type(value).__name__} too long to print"
