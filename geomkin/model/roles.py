"""The roles of curves, marks and regions of a scene: how a drawing shows each, and under which words it is switched."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

Role = Literal[
    "dimension",  # straight curves from one end of a length to the other, their label its size
    "traced",  # what a point draws, or a part is wanted for: the one accent
    "wanted",  # what was asked for: the second accent
    "construction",  # thin lines that explain: pitch circles, centre lines, image poles
    "pitch",  # pitch curve of a cam, pitch circles of gears
    "driven",  # where the driven pin of a guided body may not be
    "driving",  # where its driving pin may not be
    "deviation",  # where a path may lie, by tolerances and clearances
    "contact",  # where bodies touch, and the path on which they do
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

    label: text of its switch. shown: whether it is switched on at first, and in still pictures. room: share of the
    mechanism's size by which a drawing grows on each side for it; 0 if the drawing always contains all of it.
    """

    label: str
    shown: bool = True
    room: float = 0.0


# Room for elements that may extend far beyond the mechanism: those that are the subject of a recipe, and others.
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
