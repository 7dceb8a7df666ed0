"""Recipes of linkages: plates with pin holes and slots, how they are stacked, and the motion of every body."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..linkage.double_sliders import EllipticTrammel, OldhamCoupling, ScotchYoke
from ..linkage.four_bar import FourBar
from ..linkage.inverted_slider_crank import InvertedSliderCrank
from ..linkage.limits import driver_limits
from ..linkage.measures import grashof_type, least_transmission_angle
from ..linkage.opening import opening
from ..linkage.shaper import Shaper
from ..linkage.six_bars import StephensonSixBar, WattSixBar
from ..linkage.slider_crank import SliderCrank
from ..linkage.solve import move
from ..part import Part
from ..shop.links import link_parts
from ..shop.stack import stack_links
from ..shop.stock import LinkStock
from ..sizes import NotBoolean, entry
from ..table import Table
from .branches import Branches, branch_of, branches_entry
from .dyad_list import WITH_SLIDER, DyadList
from .kind import Kind
from .motion_table import motion_table
from .settings import Files, Stroke, Turn


def _kind(name: str, sizes: type, about: str) -> Kind:
    """A kind of linkage by its sizes; all of them are moved, judged and cut alike."""
    slides = sizes in (SliderCrank, EllipticTrammel, DyadList)
    fields: list[tuple[str, Any, Any]] = [
        ("kind", Literal[name], dataclasses.field()),  # type: ignore[valid-type]
        ("linkage", sizes, dataclasses.field()),
        ("branch", Annotated[Literal[1, -1, "follow"], NotBoolean()], entry(
            "1 or -1: a dyad's joint left or right of the line from its first to its second pivot; "
            "follow: smoothly on from 1, or from what branches says, also through change points", default=1)),
    ]  # fmt: skip
    fields.append(("branches", Branches, branches_entry()))
    fields.append(("drive", Turn, entry("how the driver turns", default=Turn())))
    if slides:
        fields.append(("stroke", Stroke | None, entry("how the driver slides, where a slide drives", default=None)))
    fields += [
        ("stock", LinkStock, entry("what the links are cut from", default=LinkStock())),
        ("files", Files, entry("what is written", default=Files())),
    ]
    recipe = dataclasses.make_dataclass(
        f"{sizes.__name__}Recipe", fields, frozen=True,
        namespace={
            "__doc__": about,
            "__post_init__": _agree,
            "signs": cached_property(branch_of),
            "motion": cached_property(lambda r: move(r.linkage, r.way.frames, r.signs, r.way.speed)),
            "fine_motion": cached_property(lambda r: move(r.linkage, r.way.fine, r.signs, r.way.speed)),
            "stack": cached_property(lambda recipe: stack_links(recipe.fine_motion, recipe.stock)),
            "way": property(lambda recipe: getattr(recipe, "stroke", None) or recipe.drive),
        },
    )  # fmt: skip
    return Kind(recipe, _table, _checks, _parts, _notes, _fit(sizes))


# What drives by sliding, and how far it goes in an example.
SLIDING: dict[type, dict[str, Any]] = {
    SliderCrank: {"linkage.driver": "slider", "stroke": Stroke(start=70, end=110)},
    EllipticTrammel: {"linkage.driver": "shuttle", "stroke": Stroke(start=-45, end=45)},
    DyadList: {"linkage": dataclasses.replace(WITH_SLIDER, driver="block"), "stroke": Stroke(start=70, end=110)},
}


def _fit(sizes: type) -> Callable[[Mapping[str, str]], dict[str, Any]]:
    """Of the tables that a template is to show, the sizes that go with them."""

    def fit(asked: Mapping[str, str]) -> dict[str, Any]:
        if "stroke" in asked:
            return SLIDING[sizes]
        return {"linkage": WITH_SLIDER} if asked else {}

    return fit


def _agree(recipe: Any) -> None:
    sliding = recipe.linkage.linkage.driven_slider is not None
    if sliding and recipe.stroke is None:
        raise DesignError("stroke", "is missing where a slide drives", "give a table with start and end")
    if not sliding and getattr(recipe, "stroke", None) is not None:
        raise DesignError("stroke", "is given, but the driver turns", "leave it out, or let the slider drive")
    # At most so many columns come of the bodies, the slides and the points that are no pins.
    linkage = recipe.linkage.linkage
    points = sum(len(held) for held in linkage.bodies.values()) - sum(map(len, linkage.pins.values()))
    joints = len(linkage.pins)
    recipe.way.check_rows(3 + 4 * len(linkage.bodies) + 5 * len(linkage.sliders) + 6 * points + joints)


def _table(recipe: Any) -> Table:
    return motion_table(recipe.motion)


def _checks(recipe: Any) -> list[Check]:
    """Whether the driver runs through, how well it drives, and whether the plates pass each other."""
    motion = recipe.motion
    reached = 100 * motion.closed.mean()
    driver, turns, opens = motion.linkage.driver, motion.linkage.driven_slider is None, opening(motion)
    advice = f"shorten the {driver} or give a shorter way" if turns else "give a shorter stroke"
    least = float(np.degrees(least_transmission_angle(motion)))
    # Where the driver drives nothing else there is no angle to judge.
    untold = motion.closed.any() and np.isnan(least)
    return [
        Check(
            f"share of the {driver}'s {'turn' if turns else 'stroke'} reached", reached, "at least", 100, "%",
            f"{opens}; {advice}" if opens else advice,
        ),
        *([] if untold else [Check(
            "least transmission angle", least, "at least", 40, "deg",
            "a driving link pushes the driven one along itself",
        )]),
        Check(
            "pin hole to thickness", recipe.stock.hole_diameter / recipe.stock.thickness, "at least", 0.5, "",
            "smaller holes burn or break out when cut",
        ),
        Check(
            "plates and pins that collide", len(recipe.stack.collisions), "at most", 0, "",
            "summary.json names them under stack; give narrower bars or other lengths",
        ),
        *(recipe.way.checks if isinstance(recipe.way, Turn) else ()),
    ]  # fmt: skip


def _parts(recipe: Any) -> list[Part]:
    return link_parts(recipe.fine_motion, recipe.stock, recipe.stack)


def _notes(recipe: Any) -> dict[str, Any]:
    """How far the driver goes, what turns fully, and how the plates lie on each other."""
    way, sizes = recipe.way, recipe.linkage
    in_deg = isinstance(way, Turn)
    limits = driver_limits(sizes, recipe.signs, (float(way.fine[0]), float(way.fine[-1])))
    shown = [[float(f"{np.degrees(q) if in_deg else q:.10g}") for q in part] for part in limits]
    grashof = {"grashof_type": grashof_type(sizes)} if isinstance(sizes, FourBar) else {}
    return {f"driver_reaches_{'deg' if in_deg else 'mm'}": shown, **grashof, "stack": recipe.stack.summary()}


KINDS = {
    name: _kind(name, sizes, about)
    for name, sizes, about in (
        (
            "four-bar", FourBar,
            "A four-bar linkage: plates with pin holes, and the motion of every link and of a coupler point.",
        ),
        ("slider-crank", SliderCrank, "A slider-crank, driven by crank, connecting rod or slider."),
        (
            "inverted-slider-crank", InvertedSliderCrank,
            "A slotted lever, a Whitworth quick return, or a rod that slides through a rocking block.",
        ),
        ("stephenson-six-bar", StephensonSixBar, "A four-bar whose coupler point drives an output, which can dwell."),
        ("watt-six-bar", WattSixBar, "Two four-bars in a row: the first one's rocker drives the second."),
        ("shaper", Shaper, "A crank shaper: a slotted lever that drives a ram, slowly there and quickly back."),
        ("elliptic-trammel", EllipticTrammel, "A rod whose pins run in two crossing slots: its points draw ellipses."),
        ("scotch-yoke", ScotchYoke, "A crank pin in a slotted yoke: straight harmonic motion."),
        ("oldham-coupling", OldhamCoupling, "Two slotted hubs and a disc between: shafts apart that turn alike."),
        ("linkage", DyadList, "Any linkage, as a list of bodies: where two name the same point, a pin joins them."),
    )
}  # fmt: skip
