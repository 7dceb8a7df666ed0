"""The moving picture read back: key frames, taken as a browser takes them, against the motion's table."""

import csv
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.scene_svg import key_frames
from tests.export.stills import SPACE, motions, placed, pose_at, root_of, titled

ROOT = Path(__file__).parents[2]
RECIPES = ROOT / "recipes"
GALLERY = sorted(file.stem for file in RECIPES.glob("*.toml"))


def picture(name, folder):
    recipe = gk.load(RECIPES / f"{name}.toml")
    (file,) = gk.write(recipe, folder / f"{name}-animation.svg")
    return recipe, root_of(file.read_bytes())


def moving(root, name):
    """The motion of what has this title, and how it is set on what moves."""
    group = titled(root, name)
    inner = placed(None)
    if not group.get("class"):
        inner = placed(group.get("transform"))
        group = next(other for other in root.iter(f"{SPACE}g") if group in list(other))
    return motions(root)[group.get("class").split()[1]], inner


def test_foot_in_the_animation_agrees_with_the_table(tmp_path):
    recipe, root = picture("walking-leg", tmp_path)
    gk.write(recipe.table, tmp_path / "leg.csv")
    rows = list(csv.DictReader((tmp_path / "leg.csv").read_text().splitlines()))
    motion, inner = moving(root, "foot")
    wide = float(root.get("width").removesuffix("mm"))
    for row in rows[::7]:
        place, turn = pose_at(motion, float(row["crank_angle_deg"]) / 360)
        foot = complex(float(row["foot_x_mm"]), float(row["foot_y_mm"]))
        # Half a pixel of a picture 420 wide.
        assert abs(place + turn * inner(0) - foot) < wide / 420 / 2


SOME = ["planetary", "lift-table"]
OTHERS = [pytest.param(name, marks=pytest.mark.campaign) for name in GALLERY if name not in SOME]


@pytest.mark.parametrize("name", [*SOME, *OTHERS])
def test_bodies_follow_the_motion_at_every_frame(name, tmp_path):
    recipe, root = picture(name, tmp_path)
    scene = recipe.scene
    low, high = scene.box
    share = (scene.time - scene.time[0]) / (scene.time[-1] - scene.time[0])
    for body in scene.bodies:
        stands_still = np.all(body.origin == body.origin[0]) and np.all(body.direction == body.direction[0])
        if not body.parts or body.fixed or stands_still:
            continue
        rows, _ = moving(root, body.name.replace("_", " "))
        place, turn = pose_at(rows, share)
        assert np.abs(place - body.origin).max() < 2e-3 * abs(high - low) + 0.1
        assert np.abs(turn - body.direction).max() < 1e-2


@pytest.mark.parametrize("name", [*SOME, *OTHERS])
def test_it_goes_on_without_a_jump(name, tmp_path):
    recipe, root = picture(name, tmp_path)
    style = root.find(f"{SPACE}style").text
    goes_round = recipe.scene.cyclic and recipe.scene.assembled.all()
    assert ("infinite alternate" in style) != goes_round
    assert "prefers-reduced-motion:no-preference" in style and "<script" not in style
    bodies = sum(bool(body.parts) for body in recipe.scene.bodies)
    assert (tmp_path / f"{name}-animation.svg").stat().st_size < max(85_000, 2_000 * bodies)
    assert all(rows[0, 0] == 0 and rows[-1, 0] == 1 for rows in motions(root).values())
    assert all((np.diff(rows[:, 0]) > 0).all() for rows in motions(root).values())
    # Gears look the same a pitch further; of a linkage every body is back.
    if goes_round and "linkage" in str(type(recipe.design)):
        for body in (body.name.replace("_", " ") for body in recipe.scene.bodies if body.parts and not body.fixed):
            rows, _ = moving(root, body)
            assert abs(pose_at(rows, 0)[0] - pose_at(rows, 1)[0]) < 0.02
            assert abs(pose_at(rows, 0)[1] - pose_at(rows, 1)[1]) < 1e-4


def test_few_key_frames_keep_all_others_near():
    share = np.linspace(0, 1, 361)
    turn = np.exp(2j * np.pi * share)
    rows = np.array([turn.real, turn.imag])
    for off in (1e-1, 1e-2, 1e-3):
        keys = key_frames(share, rows, off)
        between = np.interp(share, share[keys], rows[0, keys]) + 1j * np.interp(share, share[keys], rows[1, keys])
        assert keys[0] == 0 and keys[-1] == 360 and np.abs(between - turn).max() <= off
        # A chord of sagitta s spans 2 arccos(1 - s); evenly in time its points lag by less still.
        assert len(keys) <= np.ceil(2 * np.pi / (2 * np.arccos(1 - off))) + 2
    assert key_frames(share, np.array([share, 2 * share]), 1e-9) == [0, 360]
