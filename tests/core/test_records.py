"""A field is described once, where it is declared; the docstring of its class shows it."""

from __future__ import annotations

from geomkin.core.fields import entry, quantity
from geomkin.core.records import record


@record
class Ring:
    """A ring."""

    radius: float = quantity("outer radius", "mm", above=0, example=3.0)
    name: str = entry("what is engraved", default="")


@record
class Chain:
    """A chain of rings.

    Examples
    --------
    >>> Chain(Ring(3.0))
    """

    ring: Ring
    count: int = quantity("number of rings", whole=True, at_least=1, default=2)


def section(cls, name):
    """Lines of a section of a docstring by name."""
    lines = cls.__doc__.split("\n")
    start = lines.index(name) + 2
    stop = next((k for k in range(start, len(lines)) if not lines[k]), len(lines))
    return lines[start:stop]


def test_parameters_come_from_the_declarations():
    rows = section(Ring, "Parameters")
    assert rows[0] == "radius : float" and "outer radius" in rows[1].lower() and "above 0" in rows[1]
    assert rows[2] == "name : str, optional" and "engraved" in rows[3]


def test_a_table_is_described_by_its_type_and_other_sections_stay():
    assert section(Chain, "Parameters")[1].strip() == "A ring."
    assert section(Chain, "Examples") == [">>> Chain(Ring(3.0))"]


def test_a_docstring_with_parameters_is_kept():
    @record
    class Given:
        """One.

        Parameters
        ----------
        size : float
            Its own words.
        """

        size: float = quantity("other words", "mm", example=1.0)

    assert "Its own words." in Given.__doc__ and "ther words" not in Given.__doc__
