"""A follower rolled or slid on the polygon that the DXF holds gives the programmed lift back."""

import io
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.dxf import dxf
from geomkin.export.layout import lay_out
from tests.campaign import by_default

RECIPES = Path(__file__).parent.parent.parent / "recipes"
NAMES = ["roller-cam", "flat-cam", "rocker-cam", "flat-rocker-cam", "optimised-cam", "table-cam", "undercut-cam"]


def polygon(recipe):
    """The cam's outline about its axis, read back from the bytes of the file."""
    sheet = lay_out([cut(part, recipe.files.tolerance) for part in recipe.parts])
    document = ezdxf.read(io.StringIO(dxf(sheet).decode()))
    loops = [np.array([complex(*p[:2]) for p in e.get_points()]) for e in document.query('LWPOLYLINE[layer=="CUT"]')]
    (placed,) = [p for p in sheet.placed if p.cut.part.name == "cam"]
    box = placed.cut.box[0] + placed.shift
    return min(loops, key=lambda z: abs(complex(z.real.min(), z.imag.min()) - box)) - placed.shift


def to_edges(points, corners):
    """Distances of points (n,) from the edges of a polygon, (n,)."""
    start, along = corners, np.roll(corners, -1) - corners
    share = np.clip(np.real((points[:, None] - start) / along), 0, 1)
    return np.abs(points[:, None] - start - share * along).min(axis=1)


def room(cam, corners, lift, turn):
    """Room between follower and polygon at lifts (n,), the cam turned by `turn` (n,): 0 where they touch."""
    follower, base = cam.follower, cam.base_radius
    seen = corners * turn[:, None]
    if follower.kind == "translating-flat":
        return base + lift - seen.imag.max(axis=1)
    if follower.kind == "oscillating-flat":
        # The face's direction from the pivot leans by psi from the line towards the cam's axis.
        pivot, offset = follower.pivot_distance, follower.face_offset
        psi = np.arcsin((base - offset) / pivot) + lift
        side = 1 if follower.side == "above" else -1
        face = -np.exp(-1j * side * psi)
        normal = 1j * face * -side
        return (np.real((pivot - seen) * np.conj(normal)[:, None]) + offset).min(axis=1)
    if follower.kind == "translating-roller":
        height = np.sqrt((base + follower.roller_radius) ** 2 - follower.offset**2) + lift
        centre = follower.offset + 1j * height
    else:
        pivot, arm, prime = follower.pivot_distance, follower.arm_length, base + follower.roller_radius
        psi = np.arccos((pivot**2 + arm**2 - prime**2) / (2 * pivot * arm)) + lift
        centre = pivot - arm * np.exp(-1j * psi * (1 if follower.side == "above" else -1))
    return to_edges(centre * np.conj(turn), corners) - follower.roller_radius


@pytest.mark.parametrize("name", by_default(NAMES, slice(0, None, 2)))
def test_a_follower_on_the_finished_polygon_has_the_programmed_lift(name):
    recipe = gk.load(RECIPES / f"{name}.toml")
    cam, corners = recipe.cam, polygon(recipe)
    angle = np.radians(np.arange(0, 360))
    turn = np.exp(1j * cam.sense * angle)
    programmed = cam.program.motion(angle).lift - recipe.made.cut.lost_lift(angle)
    # A lift's share of the room is at least cos(pressure angle); an arm's radians count by its length.
    size = getattr(cam.follower, "arm_length", getattr(cam.follower, "pivot_distance", 1.0))
    reach = 2 * recipe.files.tolerance / np.cos(gk.pressure_angle(cam, angle)).min() / size
    low, high = programmed - 20 * reach, programmed + 20 * reach
    for _ in range(40):
        middle = 0.5 * (low + high)
        free = room(cam, corners, middle, turn) > 0
        low, high = np.where(free, low, middle), np.where(free, middle, high)
    assert np.abs(high - programmed).max() < reach
    if name == "undercut-cam":
        assert recipe.made.cut.lost_lift(angle).max() > 10 * reach
