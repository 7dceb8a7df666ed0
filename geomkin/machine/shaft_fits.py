"""The shafts of a machine in its layers: diameter, length, bores on it, and the bodies that it passes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..core.records import record
from ..model.check import Check
from ..model.part import Bought, HoleFit, Part
from ..model.scene import SceneBody
from ..plane.flatten import flatten
from ..plane.region import distances
from ..plane.vec import Complex
from .placed import PlacedMechanism
from .shafts import Shaft, ShaftGraph

# Distance between outlines and their chords where shafts pass, mm.
FINE = 0.01
# Distance of the middle of a bore from the axis, as a share of its diameter; a flat or a keyway moves the middle.
OFF_AXIS = 0.3
# Decimals of mm to which positions count as one.
PLACES = 6


@record(eq=False)
class ShaftFit:
    """A shaft in the layers of the machine.

    Parameters
    ----------
    shaft : Shaft
        The shaft.
    axis : complex
        Its axis in the machine, mm.
    bodies : dict of str to SceneBody
        The joined bodies by their names, the turning one first.
    bores : dict of str to HoleFit or None
        Bore of each joined body on the axis; None without a bore.
    layers : tuple of int
        Lowest and highest layer of the joined bodies.
    length : float
        Thickness of all these layers, mm.
    """

    shaft: Shaft
    axis: complex
    bodies: Mapping[str, SceneBody]
    bores: Mapping[str, HoleFit | None]
    layers: tuple[int, int]
    length: float

    @property
    def diameter(self) -> float:
        """Diameter of the bore of the body that turns it, or of another one, mm; nan without bores."""
        return next((bore.diameter for bore in self.bores.values() if bore is not None), np.nan)

    @property
    def bought(self) -> tuple[Bought, ...]:
        """The shaft itself; none without bores."""
        if not self.diameter > 0:
            return ()
        name = f"shaft {self.diameter:g} mm, at least {float(f'{self.length:.10g}'):g} mm and the gaps long"
        return (Bought(name, 1, tuple(self.bodies)),)

    @property
    def step(self) -> str:
        """The assembly step of the shaft."""
        bodies = " and ".join(self.bodies)
        return f"put one shaft through {bodies}, fixed to each, instead of the shaft or screw that each has by itself"

    def checks(self, mechanisms: Sequence[PlacedMechanism]) -> Iterator[Check]:
        """Checks that the bores have the shaft's diameter and that it touches no body of the layers it crosses."""
        id = f"{self.shaft.mechanism}_{self.shaft.body}_shaft".replace(" ", "_")
        bores = {name: bore.diameter if bore else np.nan for name, bore in self.bores.items()}
        words = ", ".join(f"{name} {bore:g} mm" if bore > 0 else f"{name} none" for name, bore in bores.items())
        advice = "give all bodies on this shaft the same bore: bore of gears and cams, pin_diameter of linkages"
        spread = float(np.ptp(list(bores.values())))
        yield Check(f"{id}_bores", f"difference of bores on one shaft ({words})", spread, "at most", 0.0, "mm", advice)
        if not self.diameter > 0:
            return
        room, name = min(self._rooms(mechanisms), default=(np.inf, ""))
        beside = f" and {name}" if name else ""
        advice = "change the order of the mechanisms, let one be upside_down, or change its angle_deg"
        yield Check(
            f"{id}_room",
            f"distance of shaft {self.shaft}{beside}",
            room - self.diameter / 2,
            "at least",
            0.0,
            "mm",
            advice,
        )

    def _rooms(self, mechanisms: Sequence[PlacedMechanism]) -> Iterator[tuple[float, str]]:
        """Least distance of each body in these layers from the axis, mm, and its name; of a bore on it, its radius."""
        low, high = self.layers
        for mechanism in mechanisms:
            for body in mechanism.scene.bodies:
                if not low <= body.layer <= high or body.name in self.bodies:
                    continue
                places = places_on(body, self.axis)
                for part in body.parts:
                    if (bore := bore_at(part, places)) is not None:
                        yield bore.diameter / 2, body.name
                    else:
                        loops = [flatten(curve, FINE) for curve in (part.outline, *part.holes)]
                        yield float(distances(loops, places).min()), body.name


def places_on(body: SceneBody, axis: complex) -> Complex:
    """The positions of a fixed axis in the frame of a body, mm, each once."""
    places = (axis - body.origin) * np.conj(body.direction)
    return np.unique(np.round(places[np.isfinite(places)], PLACES))


def bore_at(part: Part, places: Complex) -> HoleFit | None:
    """The fit of the hole of a part that has its middle at these places, mm."""
    for hole, fit in zip(part.holes, part.fits):
        points = hole.point(np.linspace(hole.breaks[0], hole.breaks[-1], 65))
        middle = complex(np.ptp(points.real) / 2 + points.real.min(), np.ptp(points.imag) / 2 + points.imag.min())
        if fit is not None and np.abs(places - middle).max() <= OFF_AXIS * fit.diameter:
            return fit
    return None


def shaft_fits(graph: ShaftGraph, mechanisms: Sequence[PlacedMechanism]) -> Iterator[ShaftFit]:
    """The shafts of a machine in its layers."""
    heights = {layer: height for mechanism in mechanisms for layer, height in mechanism.heights.items()}
    by_name = {mechanism.name: mechanism for mechanism in mechanisms}
    for shaft in graph.shafts:
        bodies = {}
        for name, of in ((shaft.mechanism, shaft.body), *((n, next(iter(graph.bodies[n]))) for n in shaft.turned)):
            full = f"{name}/{of}"
            bodies[full] = next(b for b in by_name[name].scene.bodies if b.name == full)
        axis = complex(by_name[shaft.mechanism].pose.place(graph.bodies[shaft.mechanism][shaft.body].axis))
        bores = {}
        for full, body in bodies.items():
            found = (bore_at(part, places_on(body, axis)) for part in body.parts)
            bores[full] = next((bore for bore in found if bore is not None), None)
        layers = [body.layer for body in bodies.values()]
        low, high = min(layers), max(layers)
        yield ShaftFit(shaft, axis, bodies, bores, (low, high), sum(heights[k] for k in range(low, high + 1)))
