"""What a scene holds: a row for each frame of everything, plots of columns there are, and the box of where it goes."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.model.scene import Scene, SceneBody, SceneMark
from geomkin.model.table import Column, Table

FRAMES = 4


def row(count=FRAMES, kind=complex):
    return np.arange(count).astype(kind)


def table(count=FRAMES):
    return Table((Column("t", "s", "time", row(count, float)), Column("a", "mm", "a", row(count, float))))


def scene(**changes):
    made = {"table": table(), "time": row(kind=float), "assembled": np.ones(FRAMES, bool), "bodies": ()}
    return Scene(**made | changes)


def test_everything_has_as_many_rows_as_there_are_frames():
    for what, changes in [
        ("time", lambda n: {"time": row(n, float)}),
        ("time", lambda n: {"assembled": np.ones(n, bool)}),
        ("body b", lambda n: {"bodies": (SceneBody("b", (), row(n), row()),)}),
        ("body b", lambda n: {"bodies": (SceneBody("b", (), row(), row(n)),)}),
        ("mark P", lambda n: {"marks": (SceneMark("point", row(n), label="P"),)}),
        ("mark Q", lambda n: {"marks": (SceneMark("vector", row(n), label="Q", vector=row(), direction=row()),)}),
        ("mark vector", lambda n: {"marks": (SceneMark("vector", row(), vector=row(n)),)}),
        ("mark slide", lambda n: {"marks": (SceneMark("slide", row(), direction=row(n)),)}),
        ("mark circle", lambda n: {"marks": (SceneMark("circle", row(), radius=row(n, float)),)}),
        (
            "the other crossed",
            lambda n: {
                "others": {
                    "crossed": Scene(table(n), row(n, float), np.ones(n, bool), ()),
                }
            },
        ),
    ]:
        assert scene(**changes(FRAMES)).drive.id == "t"
        for count in (FRAMES - 1, FRAMES + 1):
            with pytest.raises(gk.DesignError) as refusal:
                scene(**changes(count))
            assert refusal.value.field == "table" and what.split()[-1] in refusal.value.problem


@pytest.mark.parametrize("seed", range(3))
def test_box_holds_moving_bodies_and_the_origin(seed):
    """Pins, slides, what leaves a trail, and bodies; no arrow's end, no circle, no point that leaves none."""
    numbers = np.random.default_rng(seed)

    def places():
        z = (numbers.normal(size=FRAMES) + 1j * numbers.normal(size=FRAMES)) * 10 ** numbers.uniform(-1, 2)
        return np.where(numbers.random(FRAMES) < 0.2, np.nan, z)

    marks = [
        SceneMark(sort, places(), trail=trail, vector=1e6 * row())
        for sort in ("pin", "fixed pin", "slide", "point", "vector", "line", "circle")
        for trail in (False, True)
        if numbers.random() < 0.5
    ]
    bodies = tuple(SceneBody(f"b{k}", (), places(), row()) for k in range(numbers.integers(0, 3)))
    seen = [0j, *(z for body in bodies for z in body.origin.tolist())]
    for mark in marks:
        if mark.trail or mark.sort in ("pin", "slide", "fixed pin"):
            seen += mark.place.tolist()
    seen = [z for z in seen if z == z]
    x, y = [z.real for z in seen], [z.imag for z in seen]
    found = scene(marks=tuple(marks), bodies=bodies)
    assert found.box == (complex(min(x), min(y)), complex(max(x), max(y)))
    assert replace(found, marks=(), bodies=()).box == (0j, 0j)
