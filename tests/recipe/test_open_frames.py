"""Recipes of linkages with open or singular frames: the values there are unknown, and nothing is printed."""

from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

CASES = Path(__file__).parents[1] / "cases"


def test_loads_are_unknown_where_the_linkage_is_open():
    recipe = gk.load(CASES / "warnings-loads.toml")
    open_frames = ~recipe.motion.assembled
    assert open_frames.any() and np.isnan(recipe.table["driver_torque"][open_frames]).all()
    assert np.isfinite(recipe.table["driver_torque"][~open_frames]).any()


def test_the_inflection_circle_of_a_body_on_a_fixed_pivot_is_its_pivot():
    """Every point moves on a circle about the pivot: only the pivot itself has no path."""
    recipe = gk.load(CASES / "warnings-inflection.toml")
    assert recipe.scene and recipe.parts
    pivot = recipe.table["instant_centre_x"] + 1j * recipe.table["instant_centre_y"]
    assert pivot == pytest.approx(np.full(pivot.shape, 100))
    assert recipe.table["inflection_diameter"] == pytest.approx(np.zeros(pivot.shape), abs=1e-9)
