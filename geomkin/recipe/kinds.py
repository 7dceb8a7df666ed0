"""The one table of kinds. A new kind of mechanism is one recipe class, its `Kind` beside it and one row here."""

from __future__ import annotations

from importlib import import_module

from .kind import Kind

# Name in a recipe -> the module here that has it among its KINDS; only the one asked for is loaded.
KINDS = {
    "four-bar": "linkages",
    "slider-crank": "linkages",
    "inverted-slider-crank": "linkages",
    "stephenson-six-bar": "linkages",
    "watt-six-bar": "linkages",
    "shaper": "linkages",
    "elliptic-trammel": "linkages",
    "scotch-yoke": "linkages",
    "oldham-coupling": "linkages",
    "linkage": "linkages",
    "four-bar-atlas": "coupler_atlas",
    "slider-crank-atlas": "coupler_atlas",
    "cognates": "cognate_linkages",
    "inflection-circle": "path_curvature",
    "centrodes": "path_curvature",
    "polygons": "polygons",
    "shaking-force": "shaking_force",
    "disk-cam": "disk_cam",
    "spur-gear": "spur_gear",
    "ring-gear": "ring_gear",
    "gear-pair": "gear_pair",
    "rack-and-pinion": "gear_pair",
    "planetary": "planetary",
    "straight-sided-gears": "conjugate_gears",
    "point-tooth-gears": "conjugate_gears",
    "lantern-gears": "conjugate_gears",
}


def kind(name: str) -> Kind:
    """The kind of that name; KeyError for another."""
    return import_module(f".{KINDS[name]}", __package__).KINDS[name]
