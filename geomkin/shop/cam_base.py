"""The base of a cam: its shaft, and the pivot of an arm or the slot that guides a stem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..cam.cam import Cam
from ..cam.followers.plates import Plate
from ..cam.maxima import largest, samples
from ..cam.undercut import Undercut
from ..errors import DesignError
from ..part import Part
from ..plane.flatten import flatten
from ..plane.vec import Complex
from ..sizes import rounded_down
from .base import BaseOpening, BaseStock, standing_plate
from .motors import MotorName

# Letters at the holes that belong together, by what the stock calls their diameters; the cam's own shaft is A.
LETTERS = {"bore": "A", "pivot_bore": "B", "roller_bore": "C"}
# Places of the follower between its lowest and its highest at which room for it is looked for. Fewer miss more of an
# arm's swing between two of them, which counts by thousandths of its length; more take longer.
PLACES = 65
# Chords of outlines, as a share of the cam's size, for finding that room: as near as the swing.
CHORDS = 1e-3


def cam_base(
    cam: Cam,
    cut: Undercut,
    plates: Sequence[Plate],
    shafts: Mapping[str, float],
    thickness: float,
    base: BaseStock,
    motor: MotorName | None = None,
) -> Part:
    """The base under a cam and its follower, in the ground's frame, the cam's axis at the origin.

    plates: as `guided_plates` gives them; holes `pivot_bore` in them are over that of the pivot, or over the slot in
    which the pins slide. shafts: diameters, mm, of `bore` and `pivot_bore`. motor: what turns the cam; the base has its
    holes there. Raises DesignError where there is no room.
    Derived here.
    """
    lifts = np.linspace(*_lifts(cam), PLACES)
    pose = cam.follower.place(lifts, cam.base_radius)
    origin, direction = np.asarray(pose.origin)[:, None], np.asarray(pose.direction)[:, None]
    pins = np.array([hole.centre for plate in plates for hole in plate.holes if hole.key == "pivot_bore"])
    ways = origin + direction * pins
    shaft = BaseOpening("the cam shaft", "stock.bore", shafts["bore"], (0j,), LETTERS["bore"], motor=motor)
    openings = [shaft]
    if cam.follower.oscillates:
        pivot = complex(ways[0, 0])
        openings.append(
            BaseOpening("the arm's pivot", "stock.pivot_bore", shafts["pivot_bore"], (pivot,), LETTERS["pivot_bore"])
        )
    elif len(pins) < 2:
        raise DesignError("base", "the follower has no stem that it could guide", "leave it out")
    else:
        ends = (complex(ways[0, 0]), complex(ways[-1, -1]))
        openings.append(
            BaseOpening("the guide pins", "stock.pivot_bore", shafts["pivot_bore"], ends, LETTERS["pivot_bore"])
        )
    chords = CHORDS * cam.prime_radius
    bars = [origin + direction * flatten(p.outline, chords) for p in plates if p.name != "roller"]
    if cam.follower.knife_edge is not None:
        for bar in bars:
            _check_shaft(bar, shafts["bore"])
    reach = np.abs(cut.outline.point(samples(cut.outline.breaks))).max() + chords
    own = np.array([-reach - 1j * reach, reach + 1j * reach])
    places = np.concatenate([own, *(z.ravel() for z in bars), *_rollers(cam)])
    low, high = complex(places.real.min(), places.imag.min()), complex(places.real.max(), places.imag.max())
    # A pivot's boss lies within the bars, and so do the pins of a stem.
    return standing_plate((low, high), openings, base, thickness)


def _lifts(cam: Cam) -> tuple[float, float]:
    """Lowest and highest, mm or rad. Undercut leaves the round cam that the lowest lift alone would need."""
    program = cam.program
    highest = largest(program.breaks, lambda t: program.motion(t).lift)[0]
    lowest = -largest(program.breaks, lambda t: -program.motion(t).lift)[0]
    return lowest, highest


def _rollers(cam: Cam) -> Iterator[Complex]:
    """Corners of the boxes about the roller at each place of it."""
    radius = cam.follower.rounding
    if radius:
        contact = cam.contact(samples(cam.program.breaks).ravel())
        centre = contact.point + radius * contact.normal
        yield from (centre + radius * corner for corner in (1 + 1j, -1 - 1j))


def _check_shaft(bar: Complex, shaft: float) -> None:
    """Refuse a bar between cam and base, at places (n, points), that the cam's shaft would meet."""
    along = np.roll(bar, -1, axis=1) - bar
    share = np.clip(np.real(-bar * np.conj(along)) / np.maximum(np.abs(along) ** 2, 1e-300), 0, 1)
    room = float(np.abs(bar + share * along).min())
    inside = (np.abs(np.angle(np.roll(bar, -1, axis=1) / bar).sum(axis=1)) > np.pi).any()
    if inside or room <= shaft / 2:
        raise DesignError(
            "stock.bar_width",
            f"the bar of the follower, between cam and base, meets the cam shaft of {shaft:g} mm",
            f"give a bore of less than {rounded_down(2 * room)} mm, narrower bars or a larger base_radius"
            if room and not inside
            else "give narrower bars or a larger base_radius",
        )
