"""The errors of geomkin: each message states the field, the problem and the remedy."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral
from typing import Any, Literal

from .units import Sentence, as_sentences

# The kinds of problem. They stay the same when the texts of messages change, so that programs can rely on them.
ProblemId = Literal[
    "unknown-key",
    "missing-key",
    "unknown-kind",
    "wrong-type",
    "out-of-range",
    "not-finite",
    "conflict",  # values that are allowed singly but contradict each other
    "impossible-geometry",  # no mechanism of these sizes exists
    "does-not-assemble",
    "too-much-work",
    "invalid-toml",
    "file-unreadable",
    "file-unwritable",
    "internal",  # an error of geomkin itself
]


class GeomkinError(Exception):
    """Base class of all errors that geomkin raises on purpose; its text is shown to users without a traceback.

    See Also
    --------
    DesignError, RecipeError, FileError, FailedChecksError
    """


class DesignError(GeomkinError, ValueError):
    """A mechanism or an argument that is impossible.

    Parameters
    ----------
    field : str
        Name of the size or argument that is wrong.
    problem : str
        The given value and the reason why it is not possible.
    remedy : str
        What to change.
    id : str
        Kind of refusal, one of `ProblemId`.
    value : float, optional
        A value of the field that is accepted, if the remedy names one.

    See Also
    --------
    RecipeError, FileError

    Examples
    --------
    >>> import geomkin as gk
    >>> try:
    ...     gk.FourBar(ground=200, crank=30, coupler=90, rocker=70)
    ... except gk.DesignError as error:
    ...     print(error.field)
    ground
    """

    def __init__(
        self,
        field: str,
        problem: str,
        remedy: str,
        id: ProblemId = "impossible-geometry",
        value: float | str | None = None,
    ):
        field, problem, remedy = harmless(field), Sentence(problem, harmless), Sentence(remedy, harmless)
        super().__init__(f"{field}: {problem}; {remedy}")
        self.field, self.problem, self.remedy, self.id = field, problem, remedy, id
        self.value: float | None = None
        if value is not None:
            # The number of a whole field must stay whole.
            self.value = int(value) if isinstance(value, Integral) else float(value)

    def __reduce__(self) -> tuple[Any, ...]:
        # By default an exception is pickled with its text as the only argument, which __init__ does not accept.
        return type(self), (self.field, self.problem, self.remedy, self.id, self.value), self.__dict__

    def named(self, field: str) -> DesignError:
        """The same error of another field, such as that of a recipe."""
        return DesignError(field, self.problem, self.remedy, self.id, self.value)

    @property
    def as_problem(self) -> Problem:
        """The error as a problem of a recipe, its field being the key."""
        return Problem(self.field, self.problem, self.remedy, self.id, self.value)


@dataclass(frozen=True)
class Problem:
    """One problem of a recipe.

    Parameters
    ----------
    key : str
        Dotted key, such as `linkage.crank`; empty for the whole file.
    problem : str
        The given value and the reason why it is not possible.
    remedy : str
        What to change.
    id : str
        Kind of refusal, one of `ProblemId`.
    value : float, optional
        A value of the key that is accepted, if the remedy names one.
    """

    key: str
    problem: str
    remedy: str
    id: ProblemId = "impossible-geometry"
    value: float | None = None

    def __post_init__(self) -> None:
        as_sentences(self, "problem", "remedy")

    def to_dict(self) -> dict[str, str | float]:
        """The entries of the problem in JSON."""
        known = {} if self.value is None else {"value": self.value}
        return {name: harmless(getattr(self, name)) for name in ("id", "key", "problem", "remedy")} | known

    def __repr__(self) -> str:
        return printable(f"Problem({self})", 120)

    def __str__(self) -> str:
        return harmless(f"{self.key or '(whole file)'}: {self.problem}; {self.remedy}")


# Largest number of problems in the text of a RecipeError: the first is mostly the cause of the others.
MOST_SHOWN = 20


class RecipeError(GeomkinError, ValueError):
    """A recipe that cannot be read or made, with all its problems at once.

    Parameters
    ----------
    file : str
        Name of the recipe's file.
    problems : list of Problem
        The problems; the text shows the first 20.

    See Also
    --------
    DesignError, FileError, load
    """

    def __init__(self, file: str, problems: list[Problem]):
        lines = [f"{printable(file)}: {p}" for p in problems[:MOST_SHOWN]]
        if len(problems) > MOST_SHOWN:
            lines.append(f"{printable(file)}: and {len(problems) - MOST_SHOWN:,} more problems; fix these first")
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

    See Also
    --------
    RecipeError, DesignError
    """

    def __init__(self, file: object, problem: str, remedy: str, id: ProblemId):
        self.file, self.problem, self.remedy, self.id = printable(file), harmless(problem), harmless(remedy), id
        super().__init__(f"{self.file}: {self.problem}; {self.remedy}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.file, self.problem, self.remedy, self.id), self.__dict__


def harmless(text: object) -> str:
    """`text` as one line without control characters, including those that change the direction of writing."""
    line = str(text)
    return line if line.isprintable() else "".join(c if c.isprintable() else "?" for c in line)


def printable(text: object, longest: int = 80) -> str:
    """`text` as one line for a terminal: no control characters, and at most `longest` characters.

    A longer text loses its middle, since a path is recognised by its two ends.
    """
    line = harmless(text)
    return line if len(line) <= longest else f"{line[: longest // 2]}...{line[-(longest // 2 - 3) :]}"


def shown(value: object) -> str:
    """A value as it was written, on one line of limited length, whatever its type."""
    try:
        return printable(repr(value))
    except (ValueError, RecursionError):
        return f"{with_article(type(value).__name__)} too long to print"


def with_article(word: str) -> str:
    """The word after `a`, or after `an` if it begins with a vowel."""
    return f"{'an' if word[:1].lower() in ('a', 'e', 'i', 'o', 'u') else 'a'} {word}"
