"""The gallery's scenes, and what tests of scenes see of a body at a frame."""

import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import shapely

import geomkin as gk

RECIPES = Path(__file__).parents[1] / "recipes"
NAMES = sorted(path.stem for path in RECIPES.glob("*.toml"))
FIRST_OF_KIND = {tomllib.loads((RECIPES / f"{name}.toml").read_text("utf-8"))["kind"]: name for name in reversed(NAMES)}
# mm. Of the chords that outlines are looked at by.
FINE = 1e-4


@cache
def recipe(name):
    return gk.load(RECIPES / f"{name}.toml")


def named(scene, name):
    return next(body for body in scene.bodies if body.name == name)


def marks(scene, sort, label=""):
    return [mark for mark in scene.marks if mark.sort == sort and label in mark.label]


@cache
def _loops(part):
    return gk.flatten(part.outline, FINE), tuple(gk.flatten(hole, FINE) for hole in part.holes)


def seen(body, frame):
    """The first part of a body as a polygon where it stands."""
    outline, holes = _loops(body.parts[0])

    def placed(z):
        z = body.origin[frame] + body.direction[frame] * z
        return np.column_stack([z.real, z.imag])

    return shapely.Polygon(placed(outline), [placed(hole) for hole in holes])


def point(z):
    return shapely.Point(z.real, z.imag)


def frames(scene, count=13):
    return np.unique(np.linspace(0, len(scene.time) - 1, count).astype(int)).tolist()
