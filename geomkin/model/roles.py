"""The roles of curves, marks and regions of a scene: the style of each and the text of its switch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

Role = Literal[
    "dimension",  # segments along a length; the label is its size
    "traced",  # paths of points, and curves for which a part is made; in the first accent colour
    "wanted",  # requirements of a synthesis; in the second accent colour
    "construction",  # thin auxiliary lines: centre lines, image poles
    "pitch",  # pitch curve of a cam, pitch circles of gears
    "driven",  # region without usable driven pins of a guided body
    "driving",  # region without usable driving pins
    "deviation",  # band of possible paths, by tolerances and clearances
    "contact",  # contacts of bodies and the path of contact
    "centrode",
    "inflection",
    "bobillier",  # Bobillier's construction
    "centre",  # instant centres
    "velocity",
    "acceleration",
    "force",
]


class RoleStyle(NamedTuple):
    """How a drawing treats a role.

    label: text of its switch. shown: whether it is visible at first and in still pictures. room: largest margin that a
    drawing adds on each side for it, as a share of the mechanism's size; 0 if the drawing always contains all of it.
    """

    label: str
    shown: bool = True
    room: float = 0.0


# `room` of roles whose elements may extend far beyond the mechanism: of those that are the subject of a recipe, and of
# the others.
WIDE, NARROW = 0.5, 0.25

# In the order of the switches.
ROLES: Mapping[Role, RoleStyle] = {
    "dimension": RoleStyle("dimensions", False, NARROW),
    "traced": RoleStyle("traced path"),
    "wanted": RoleStyle("wanted"),
    "construction": RoleStyle("construction"),
    "pitch": RoleStyle("pitch curves"),
    "driven": RoleStyle("no driven pin here", True, NARROW),
    "driving": RoleStyle("no driving pin here", True, NARROW),
    "deviation": RoleStyle("deviation"),
    "contact": RoleStyle("contact"),
    "centrode": RoleStyle("centrodes", True, WIDE),
    "inflection": RoleStyle("inflection circle", True, WIDE),
    "bobillier": RoleStyle("Bobillier construction", False, NARROW),
    "centre": RoleStyle("instant centres", False, NARROW),
    "velocity": RoleStyle("velocities", False, NARROW),
    "acceleration": RoleStyle("accelerations", False, NARROW),
    "force": RoleStyle("forces", False, NARROW),
}
