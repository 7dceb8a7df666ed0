"""From sizes and drive to motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import DesignError
from ..plane.vec import Array, direction_deg
from .closure import close_four_bar
from .four_bar import FourBar
from .measures import transmission_angle
from .motion import Body, Motion, still


def move(
    linkage: FourBar, drive: ArrayLike, branch: int = 1, speed: ArrayLike = 1.0, acceleration: ArrayLike = 0.0
) -> Motion:
    """Motion of a four-bar whose crank stands at `drive`, rad from the ground line, turning at `speed`.

    drive: (frames,). speed rad/s and acceleration rad/s2: numbers or (frames,). branch +1: the
    coupler-rocker pin lies left of the line from crank pin to rocker pivot; -1: right. A frame that the
    linkage cannot reach is nan with closed False. At an exact toggle the rates are not finite.
    """
    if branch not in (1, -1):
        raise DesignError("branch", f"found {branch!r}", "give +1 or -1")
    angle = np.atleast_1d(np.asarray(drive, dtype=float))
    if angle.ndim != 1 or not np.isfinite(angle).all():
        raise DesignError("drive", "found something else than one row of finite angles", "give (frames,) angles in rad")
    rate = np.broadcast_to(np.asarray(speed, dtype=float), angle.shape)
    gain = np.broadcast_to(np.asarray(acceleration, dtype=float), angle.shape)
    frame = complex(direction_deg(linkage.ground_angle_deg))
    loop = close_four_bar(linkage.ground, linkage.crank, linkage.coupler, linkage.rocker, angle, branch)
    closed = np.isfinite(loop.coupler)

    def open_is_nan(values: Array) -> Array:
        return np.where(closed, values, np.nan)

    zero = np.zeros(len(angle))
    pivots = still(linkage.origin, len(angle)), still(linkage.origin + frame * linkage.ground, len(angle))
    ground = Body(pivots[0], zero + frame, zero, zero)
    crank = Body(pivots[0], open_is_nan(frame * np.exp(1j * angle)), open_is_nan(rate), open_is_nan(gain))
    coupler = Body(
        crank.point(linkage.crank),
        frame * loop.coupler,
        loop.coupler_first * rate,
        loop.coupler_second * rate**2 + loop.coupler_first * gain,
    )
    rocker = Body(
        pivots[1],
        frame * loop.rocker,
        loop.rocker_first * rate,
        loop.rocker_second * rate**2 + loop.rocker_first * gain,
    )
    return Motion(
        drive=angle,
        bodies={"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker},
        named_points={
            "crank_pin": ("crank", complex(linkage.crank)),
            "rocker_pin": ("rocker", complex(linkage.rocker)),
            "coupler_point": ("coupler", complex(linkage.coupler_point)),
        },
        closed=closed,
        transmission_angle=transmission_angle(loop.coupler, loop.rocker),
    )
