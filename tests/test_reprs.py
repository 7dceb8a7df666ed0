"""What a shell shows of geomkin's things: one line of at most 120 characters that tells what it is."""

import contextlib
import dataclasses
import inspect
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.reprs import LONGEST, clipped, one_line, short

from .hostile.test_wrong_arguments import GOOD, PUBLIC
from .tradeoff.toy import CHART

RECIPES = Path(__file__).parent.parent / "recipes"


def offered(thing: object) -> Iterator[tuple[str, object]]:
    """Fields and properties of a thing of geomkin."""
    names = [f.name for f in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else []
    for name, member in inspect.getmembers_static(type(thing)):
        if not name.startswith("_") and not inspect.isfunction(member) and name != "optima":
            names.append(name)
    for name in dict.fromkeys(names):
        with contextlib.suppress(gk.GeomkinError):
            yield name, getattr(thing, name)


def found(thing: object, seen: dict[int, object], depth: int = 3) -> dict[int, object]:
    """All that is of geomkin in a result, down to what its fields and properties hold."""
    if isinstance(thing, tuple | list):
        for one in thing[:3]:
            found(one, seen, depth)
    elif isinstance(thing, dict):
        found(list(thing.values()), seen, depth)
    elif type(thing).__module__.startswith("geomkin") and not isinstance(thing, type) and id(thing) not in seen:
        seen[id(thing)] = thing
        if depth and not isinstance(thing, gk.recipe.AbstractRecipe):
            for _, held in offered(thing):
                found(held, seen, depth - 1)
    return seen


@pytest.fixture(scope="module")
def everything() -> list[object]:
    """Every public thing that can be made by the calls of GOOD, all that these hold, and recipes."""
    seen: dict[int, object] = {}
    kept = [PUBLIC[name](**arguments) for name, arguments in GOOD.items()]
    slides = gk.move(gk.SliderCrank(30, 90, 5), [0.1, 0.2])
    kept += [gk.linkage.assembly_failure(gk.move(gk.FourBar(100, 80, 90, 40), np.linspace(0, 6, 90)))]
    kept += [slides.slide(slider.name) for slider in slides.linkage.sliders]
    plates = gk.TranslatingRoller(10).plates(gk.cam.CamStock().bars, GOOD["Cam"]["program"], 40.0, 1)
    kept += [plates, plates[0].holes, gk.Cam(**GOOD["Cam"]).contact(1.0)]
    kept += [
        gk.synthesis.Found(linkage=gk.FourBar(3, 1, 3, 2), branch=1, drive=np.zeros(2), transmission_angle_deg=9.0)
    ]
    kept += [CHART, gk.tradeoff.stability([0.1])]
    kept += [gk.load(file) for file in sorted(RECIPES.glob("*.toml"))]
    kept += [gk.load(RECIPES / f"{name}.toml") for name in ("crank-rocker", "roller-cam", "gear-pair")]
    kept += [(recipe.table, recipe.checks, recipe.parts) for recipe in kept[-3:]]
    for one in kept:
        found(one, seen)
    return list(seen.values())


def flaw(thing: object) -> str:
    """What is wrong with how a thing is shown; empty where nothing is."""
    line = repr(thing)
    if not line.isprintable() or len(line) > LONGEST:
        return f"{type(thing).__name__} ({type(thing).__module__}): {len(line)} characters: {line[:100]!r}"
    if type(thing).__name__ not in line:
        return f"{type(thing).__name__} ({type(thing).__module__}): does not tell what it is: {line}"
    return ""


def test_everything_is_shown_on_one_line(everything):
    wrong = {type(thing).__name__: flaw(thing) for thing in everything if flaw(thing)}
    assert not wrong, "give these `__repr__ = one_line`:\n" + "\n".join(sorted(wrong.values()))


def test_nearly_everything_public_was_looked_at(everything):
    """Errors aside, and what is a base of others."""
    kinds = {type(thing) for thing in everything}
    classes = {kind for kind in PUBLIC.values() if isinstance(kind, type) and not issubclass(kind, Exception)}
    bases = {base for kind in kinds for base in kind.__mro__[1:]}
    # A row of values is shown as the values are.
    missed = {kind.__name__ for kind in classes - kinds - bases if not issubclass(kind, tuple)}
    assert not {name for name in missed if not name.startswith("Abstract")}


@dataclasses.dataclass(frozen=True)
class Toy:
    what: object
    left: float = 0.5
    count: int = 1
    name: str = "toy"
    held: tuple[object, ...] = ()
    hidden: object = dataclasses.field(default=None, repr=False)
    __repr__ = one_line


@pytest.mark.parametrize(
    ("what", "told"),
    [
        (1 / 3, "0.333333"),
        (np.float64(40), "40"),
        (1 + 1j / 3, "1+0.333333j"),
        (np.array(2.5), "2.5"),
        (np.nan, "nan"),
        (True, "True"),
        (np.bool_(True), "True"),
        (None, "None"),
        ("a\nb", r"'a\nb'"),
        ("x" * 90, "'" + "x" * 35 + "...'"),
        (np.zeros((361, 2), complex), "<361 x 2 complex>"),
        (np.zeros(3), "<3 real>"),
        (np.zeros(3, int), "<3 whole>"),
        (np.zeros(3, bool), "<3 bool>"),
        (np.array(["a"]), "<1 text>"),
        (np.array([None, None]), "<2 object>"),
        ((), "()"),
        ((1.0, 1 / 3), "(1, 0.333333)"),
        ((1.0,) * 4, "<4 float>"),
        ((1, 2, "a"), "(1, 2, 'a')"),
        ((gk.plane.Circle(0j, 1.0), gk.plane.Segment(0j, 1j)), "<2 Circle or Segment>"),
        ({"a": 1, "b": 2}, "{a, b}"),
        ({f"joint{k}": k for k in range(20)}, "{joint0, joint1, joint2, joint3, joi...}"),
        (gk.plane.Circle(0j, 1.0), "Circle(...)"),
        (np.sin, "sin"),
        (gk.area, "area"),
        (float, "float"),
        (object(), "object(...)"),
    ],
)  # fmt: skip
def test_a_value_is_told_in_few_characters(what, told):
    assert short(what) == told
    assert repr(Toy(what)) == f"Toy(what={told})"


def test_what_is_left_at_its_default_or_hidden_is_not_told():
    assert repr(Toy(1, 0.25, 1, "toy", (), 7)) == "Toy(what=1, left=0.25)"
    # True is no count of 1.
    assert repr(Toy(1, count=True)) == "Toy(what=1, count=True)"
    assert repr(Toy(1, left=np.zeros(2))) == "Toy(what=1, left=<2 real>)"


def test_a_line_too_long_is_cut_and_says_so():
    line = repr(Toy("x" * 90, 1 / 3, 10**30, "y" * 90, (1, 2)))
    assert len(line) == LONGEST and line.endswith("...)")
    assert len(repr(Toy(10**5000))) < LONGEST


def test_lines_of_what_a_shell_shows_most():
    circle = gk.plane.Circle(0j, 2.0)
    table = gk.Table((gk.Column("crank_angle", "deg", "angle of the crank", np.arange(3.0)),))
    assert repr(circle) == "Circle(centre=0+0j, radius=2)"
    assert repr(gk.Part("plate", circle, (circle,), 3.0)) == (
        "Part(name='plate', outline=Circle(...), holes=<1 Circle>, thickness=3)"
    )
    assert repr(table) == "Table(3 rows: crank_angle_deg)"
    assert repr(table.columns[0]) == (
        "Column(id='crank_angle', unit='deg', meaning='angle of the crank', values=<3 real>)"
    )
    check = gk.Check("least_wall", "least wall", 1.234567, "at least", 1.5, "mm", "make it thicker")
    assert repr(check) == "Check(FAILED: least wall 1.23457 mm, limit at least 1.5)"
    assert str(check) == "least wall 1.23 mm, should be at least 1.5 mm: make it thicker"
    assert repr(gk.Check("lift", "lift", 2.0, "at most", 2.5)) == "Check(passed: lift 2, limit at most 2.5)"


@pytest.mark.parametrize("count", [LONGEST - 1, LONGEST, LONGEST + 1, 3 * LONGEST])
def test_a_line_is_cut_where_it_is_too_long_and_ends_as_it_did(count):
    text = "ab\n" + "x" * (count - 4) + ")"
    line = clipped(text)
    if count <= LONGEST:
        assert line == text.replace("\n", "?")
    else:
        assert len(line) == LONGEST and line.startswith("ab?xxx") and line.endswith("x...)")
    assert clipped("abcdef)", 6) == "ab...)" and clipped("abcdef", 6) == "abcdef"
