"""Handles of the usual elements of a scene: points, circles, poses, boxes, and points of a plot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..plane.vec import Complex
from .scene import SceneHandle

# Distance of the handle of a pose's angle from its origin, as a share of the extent of all poses.
ARM = 0.25


def point_handle(*keys: str, at: Complex | complex, label: str = "", arrow: complex = 0j) -> SceneHandle:
    """A point that the keys place.

    Parameters
    ----------
    *keys : str
        Keys of a point, of its items, or of lengths that end there.
    at : complex or complex array, shape (frames,)
        Its position, mm.
    label : str
        For people; by default the last name of the first key.
    arrow : complex
        Vector of an arrow that ends there, mm.
    """
    places = np.atleast_1d(np.asarray(at, complex))
    return SceneHandle(f"point:{keys[0]}", label or _words(keys[0]), keys, places, arrow=arrow)


def circle_handle(
    *keys: str, radius: float, centre: Complex | complex = 0j, label: str = "", is_one_value: bool = False
) -> SceneHandle:
    """A circle whose radius the keys give, mm; with `is_one_value` all keys have the same value."""
    at = np.atleast_1d(np.asarray(centre, complex))
    label = label or _words(keys[0])
    return SceneHandle(f"circle:{keys[0]}", label, keys, at, "circle", radius, is_one_value=is_one_value)


def plot_handle(*keys: str, at: complex, column: str, label: str = "") -> SceneHandle:
    """A point of the plot of a column: x and y in the plot's units."""
    return SceneHandle(f"plot:{keys[0]}", label or _words(keys[0]), keys, np.array([at]), "plot", column=column)


def pose_handles(key: str, poses: Sequence[Sequence[float]]) -> Iterator[SceneHandle]:
    """Two handles for each pose [x, y, angle in deg] of a list: its origin, and a point on its x axis."""
    rows = np.array(poses, dtype=float).reshape(-1, 3)
    places = rows[:, 0] + 1j * rows[:, 1]
    arm = ARM * (max(np.ptp(places.real), np.ptp(places.imag)) or 1.0)
    for k, (place, turn) in enumerate(zip(places, np.exp(1j * np.radians(rows[:, 2])))):
        row = f"{key}[{k}]"
        yield point_handle(f"{row}[0]", f"{row}[1]", at=place, label=f"pose {k + 1}")
        yield point_handle(f"{row}[2]", at=place + arm * turn, label=f"angle of pose {k + 1}")


def list_handles(key: str, points: Sequence[complex], label: str) -> Iterator[SceneHandle]:
    """A handle for each point of a list, mm."""
    for k, z in enumerate(points):
        yield point_handle(f"{key}[{k}]", at=z, label=f"{label} {k + 1}")


def _words(key: str) -> str:
    return key.rpartition(".")[2].replace("_", " ")
