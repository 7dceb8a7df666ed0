"""What is cut out of a wheel between its hub and its rim."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...errors import DesignError
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, Polyline
from ...sizes import FARTHEST, check_sizes, entry, quantity


@dataclass(frozen=True)
class Web:
    """Openings between the hub and the rim, one between each two spokes; a spoke stands on +y."""

    hub: float = quantity("diameter of the hub", "mm", above=0, at_most=FARTHEST, example=16)
    rim: float = quantity("thickness of the rim under the teeth", "mm", above=0, at_most=FARTHEST, example=4)
    form: Literal["spokes", "holes"] = entry("openings that leave straight spokes, or round holes", default="spokes")
    count: int = quantity("number of openings", whole=True, default=5, at_least=2, at_most=100)
    spoke_width: float = quantity(
        "width of the spokes, or least width between holes", "mm", default=4.0, above=0, at_most=FARTHEST
    )

    def __post_init__(self) -> None:
        check_sizes(self)


def openings(web: Web | None, bore: float, root_radius: float, key: str) -> tuple[AbstractCurve, ...]:
    """The openings of a wheel about the origin, whose hole and keyway stay within `bore`, mm, of the axis.

    root_radius: of the bottom of the teeth, mm. Raises DesignError, of sizes named `key`.hub and so on, where the
    openings run into each other, the hole or the teeth.
    """
    if web is None:
        return ()
    inner, outer = web.hub / 2, root_radius - web.rim
    if inner <= bore:
        raise DesignError(
            f"{key}.hub",
            f"found {web.hub:g} mm around a hole of {2 * bore:.4g} mm",
            f"give more than {2 * bore:.4g} mm",
        )
    if outer <= inner:
        most = root_radius - inner
        raise DesignError(
            f"{key}.rim",
            f"found {web.rim:g} mm, which leaves no room between hub and rim",
            f"give less than {most:.4g} mm" if most > 0 else "give a smaller hub",
        )
    opening = _window(web, inner, outer, key) if web.form == "spokes" else _hole(web, inner, outer, key)
    places = 1j * np.exp(2j * np.pi * (np.arange(web.count) + 0.5) / web.count)
    if isinstance(opening, Circle):
        return tuple(Circle(complex(opening.centre * place), opening.radius) for place in places)
    return tuple(Polyline(opening.vertices * place, opening.bulges) for place in places)


def _hole(web: Web, inner: float, outer: float, key: str) -> Circle:
    """The round hole on +x that fills the room between hub and rim."""
    middle, radius = (inner + outer) / 2, (outer - inner) / 2
    between = 2 * middle * float(np.sin(np.pi / web.count)) - 2 * radius
    if between < web.spoke_width:
        raise DesignError(
            f"{key}.count",
            f"found {web.count} holes of {2 * radius:.4g} mm with {between:.4g} mm between them",
            "give fewer holes, a thicker rim or hub, or a smaller spoke_width",
        )
    return Circle(complex(middle), radius)


def _window(web: Web, inner: float, outer: float, key: str) -> Polyline:
    """The opening on +x between two spokes, its corners rounded."""
    half, beside = np.pi / web.count, web.spoke_width / 2
    # Rounded as far as looks well on most wheels: half a spoke, but no more than leaves straight sides.
    corner = min(beside, (outer - inner) / 5)
    ray = np.exp(1j * half)
    # Along the spoke's axis, where the roundings' centres stand; the window lies to the right of it.
    places = [np.sqrt(max(r**2 - (beside + corner) ** 2, 0.0)) for r in (outer - corner, inner + corner)]
    centres = [(s - 1j * (beside + corner)) * ray for s in places]
    high, low = (float(np.angle(c)) for c in centres)
    if places[1] == 0 or low <= 0 or high <= 0:
        raise DesignError(
            f"{key}.spoke_width",
            f"found {web.spoke_width:g} mm: {web.count} spokes meet outside the hub",
            "give fewer or narrower spokes, or a larger hub",
        )
    upper = np.array([outer * np.exp(1j * high), *((s - 1j * beside) * ray for s in places), inner * np.exp(1j * low)])
    turns = np.array([np.pi / 2 + half - high, 0.0, np.pi / 2 + low - half])
    sweeps = np.concatenate([turns, [-2 * low], turns[::-1], [2 * high]])
    return Polyline(np.concatenate([upper, np.conj(upper)[::-1]]), np.tan(sweeps / 4))
