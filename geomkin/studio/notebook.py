"""Anything that moves, shown moving in a notebook: the same scene and the same page as a recipe's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial, singledispatch
from html import escape
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from ..build import load
from ..cam.cam import Cam
from ..cam.kinds.disk_cam import DiskCamRecipe
from ..cam.parts import CamStock
from ..core.arguments import ArgumentType, checked, refused
from ..core.errors import DesignError, GeomkinError, printable
from ..core.records import record
from ..export.files import write_whole
from ..export.job import Job, StaticSource
from ..gear.checks import mesh_checks
from ..gear.contract import AbstractGear
from ..gear.kinds.planetary import PlanetaryRecipe
from ..gear.kinds.single_gears import RingGearRecipe, SpurGearRecipe
from ..gear.pair import GearPair
from ..gear.parts.gears import GearStock, RingStock, gear_parts
from ..gear.planetary import PlanetarySet
from ..gear.rack import RackPair
from ..gear.ring import RingGear
from ..gear.scene_pairs import pair_scene
from ..gear.spur import SpurGear
from ..linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG, linkage_checks
from ..linkage.linkage import AbstractLinkage
from ..linkage.measures import TURN, driver_limits
from ..linkage.motion import Motion, motion_table
from ..linkage.moving import move
from ..linkage.scene import linkage_scene
from ..linkage.solve.branch import Branch
from ..model.check import Check
from ..model.part import Part
from ..model.scene import Limit, Plot, Scene, SceneBody, SceneCurve, SceneMark
from ..model.table import Column, Table, finite, xy_columns
from ..page.page import page
from ..plane.curve import AbstractCurve, extent
from ..recipe.load import to_toml
from ..recipe.recipe import AbstractRecipe
from ..recipe.settings import Files
from ..synthesis.found import Found

# Pixels of the frame: drawing, controls and plots are seen at once, and the rest below them is scrolled to. It can be
# drawn larger by its corner.
HIGH = 660
# Frames of a full turn, and of a way between limits or along a curve, both ends included.
FRAMES = 361
# Share of a way between limits that is left out at each end: at a limit itself rates are infinite, and no plot shows
# anything else. Larger, and the picture stops visibly short of it.
SHORT = 1e-3
# Of parts in a picture: the distance between outline and chords as a share of the smallest one's size, and the least
# share of the largest one's that can be cut.
FINE, FINEST = 1e-3, 2e-7


@record(eq=False)
class Shown:
    """A page that shows something moving, as a notebook shows it at the end of a cell. name: its title."""

    name: str
    page: bytes

    def __repr__(self) -> str:
        return f"Shown({printable(self.name, 60)}: a page of {len(self.page) / 1000:.0f} kB; save(path) writes it)"

    def _repr_html_(self) -> str:
        """The page in a frame of its own, which reaches nothing of what is around it."""
        told = escape(self.page.decode("utf-8"))
        style = f"width:100%;height:{HIGH}px;border:0;resize:vertical;overflow:auto"
        allowed = 'sandbox="allow-scripts allow-downloads"'
        return f'<iframe title="{escape(self.name)}" {allowed} style="{style}" srcdoc="{told}"></iframe>'

    @checked
    def save(self, path: str | Path) -> Path:
        """Write the page to a file, which opens from a folder or a mail; the path. FileError where it cannot be."""
        path = Path(path)
        write_whole(path.parent, {path.name: self.page})
        return path


def _is_shown(value: Any) -> bool:
    if isinstance(value, (tuple, list)):
        return bool(value) and all(isinstance(one, Part) for one in value)
    return _job.dispatch(type(value)) is not _job.dispatch(object)


WHAT = ArgumentType(
    _is_shown,
    "a recipe, its file or text, a linkage, a motion, a cam, a gear, a pair of gears, a planetary set, a part or "
    "several, a curve, or a linkage that a synthesis found",
)
Showable = Annotated[Any, WHAT]


@checked
def show(thing: Showable) -> Shown:
    """Anything as the page that shows it moving, inline in a notebook.

    A recipe, or what `load` reads, as its own page. A linkage is driven over a full turn at 60 rpm, or as far as the
    limits of its driver allow, on branch +1; for another way or branch show `move(...)`. What a synthesis found goes
    its full turn, or over all of the wanted places. A cam turns under its follower, gears roll in mesh or under the
    tool that cuts them. A curve is run along, at an even pace of its parameter. Parts lie as on their sheet. Links, of
    which no stock is told, are lines; cams and rings have plates of fitting size.
    DesignError for what has no picture or cannot move; what `load` raises for a file.
    """
    job = _job(thing)
    return Shown(job.name, page(job))


def inline(thing: object) -> str:
    """What a notebook shows of a thing; where there is nothing to show, in words why."""
    try:
        return show(thing)._repr_html_()
    except GeomkinError as error:
        return f"<pre>{escape(repr(thing))}\n{escape(str(error))}</pre>"


@singledispatch
def _job(thing: object) -> Job:
    """What is written on the page of a thing."""
    raise refused("thing", thing, WHAT)


def _loose(
    thing: object, scene: Scene, parts: Sequence[Part] = (), checks: Sequence[Check] = (), about: str = ""
) -> Job:
    return Job(type(thing).__name__, StaticSource(tuple(parts), scene.table, scene, tuple(checks)), 1.0, about=about)


@_job.register
def _(recipe: AbstractRecipe) -> Job:
    name = recipe.name or recipe.kind
    if recipe.scene is None:
        return replace(_job(recipe.parts), name=name)
    return Job(name, recipe, recipe.files.tolerance, about=recipe.subtitle, recipe=partial(to_toml, recipe))


@_job.register(str)
@_job.register(Path)
@_job.register(Mapping)
def _(source: str | Path | Mapping[str, Any]) -> Job:
    return _job(load(source))


@_job.register
def _(motion: Motion) -> Job:
    least = LEAST_TRANSMISSION_ANGLE_DEG
    limits = {"transmission_angle": Limit(least, f"at least {least:g} deg")}
    return _loose(motion, linkage_scene(motion, motion_table(motion), limits=limits), (), linkage_checks(motion))


@_job.register
def _(linkage: AbstractLinkage) -> Job:
    return _moved(linkage, 1, None)


@_job.register
def _(found: Found) -> Job:
    return _moved(found.linkage, found.branch, (float(np.min(found.drive)), float(np.max(found.drive))))


def _moved(linkage: AbstractLinkage, branch: Branch, wanted: tuple[float, float] | None) -> Job:
    """A linkage over a full turn, or over the `wanted` places, or as far as it can."""
    if linkage.linkage.is_batch:
        raise DesignError("thing", "found an array of linkages", "give one at a time")
    slides = linkage.linkage.driven_slider is not None
    limits: tuple[tuple[float, float], ...] = ()
    try:
        limits = driver_limits(linkage, branch)
    except DesignError as error:
        if wanted is None:
            raise DesignError(
                "thing", error.problem, "show its motion instead, move(...) over the way wanted"
            ) from None
    if limits == (TURN,):
        way = np.linspace(*TURN, FRAMES)
    else:
        way = np.linspace(*(_reached(limits, slides) if wanted is None else wanted), FRAMES // 2 + 1)
    speed = float(np.ptp(way)) if slides else 2 * np.pi
    about = f"Driven at {speed:.3g} mm/s." if slides else "Driven at 60 rpm."
    return replace(_job(move(linkage, way, branch, speed or 1.0)), name=type(linkage).__name__, about=about)


def _reached(limits: Sequence[tuple[float, float]], slides: bool) -> tuple[float, float]:
    """The widest way between two limits, a hair within them."""
    if not limits:
        raise DesignError("thing", "it can be put together nowhere", "change the sizes that keep it open")
    spans = list(limits)
    (first, *_), (last, *_) = spans[0], spans[-1]
    if not slides and len(spans) > 1 and first == TURN[0] and spans[-1][1] == TURN[1]:
        # One way that the start of the turn cuts in two.
        spans = [(last - TURN[1], spans[0][1]), *spans[1:-1]]
    low, high = max(spans, key=lambda span: span[1] - span[0])
    return low + SHORT * (high - low), high - SHORT * (high - low)


@_job.register
def _(cam: Cam) -> Job:
    # Plates of its own size, without the holes that nothing is told of.
    size = cam.prime_radius
    stock = CamStock(
        thickness=0.1 * size, bore=0, roller_bore=0, pivot_bore=0, bar_width=0.3 * size, overhang=0.05 * size,
        stem_length=size,
    )  # fmt: skip
    return replace(_job(DiskCamRecipe(cam=cam, stock=stock)), name="Cam")


@_job.register
def _(gear: SpurGear) -> Job:
    return replace(_job(SpurGearRecipe(gear=gear, files=_files(gear.tip_radius))), name="SpurGear")


@_job.register
def _(gear: RingGear) -> Job:
    recipe = RingGearRecipe(gear=gear, stock=_ring_stock(gear), files=_files(gear.root_radius))
    return replace(_job(recipe), name="RingGear")


@_job.register
def _(gears: PlanetarySet) -> Job:
    recipe = PlanetaryRecipe(gears=gears, ring_stock=_ring_stock(gears.ring), files=_files(gears.ring.root_radius))
    return replace(_job(recipe), name="PlanetarySet")


def _ring_stock(ring: AbstractGear) -> RingStock:
    return RingStock(rim=max(4 * ring.module, 0.1))


def _files(radius: float) -> Files:
    """Teeth told as finely as their size asks for: nothing is written."""
    return Files(tolerance=float(np.clip(1e-4 * radius, 1e-6, 10)))


@_job.register
def _(pair: GearPair | RackPair) -> Job:
    gears: dict[str, AbstractGear] = {name: getattr(pair, name) for name in pair.names}
    parts = [part for name, gear in gears.items() for part in _plate(gear, name)]
    return _loose(pair, replace(pair_scene(pair, parts)), parts, mesh_checks(pair))


def _plate(gear: AbstractGear, name: str) -> tuple[Part, ...]:
    return gear_parts(gear, _ring_stock(gear) if gear.is_ring else GearStock(), name)


@_job.register
def _(gear: AbstractGear) -> Job:
    return replace(_job(_plate(gear, "gear")), name=type(gear).__name__)


@_job.register
def _(part: Part) -> Job:
    return _job((part,))


@_job.register(tuple)
@_job.register(list)
def _(parts: Sequence[Part]) -> Job:
    """As they lie on their sheet."""
    sizes = [extent(part.outline) for part in parts]
    tolerance = max(FINE * min(sizes), FINEST * max(sizes))
    sheet = Job("parts", StaticSource(tuple(parts)), tolerance).sheets[0]
    one = np.ones(1, dtype=complex)
    names = [placed.cut.part.name for placed in sheet.placed]
    told = [f"{name} {names[:k].count(name) + 1}" if names.count(name) > 1 else name for k, name in enumerate(names)]
    bodies = tuple(
        SceneBody(name, (placed.cut.part,), placed.shift * one, placed.turn * one)
        for name, placed in zip(told, sheet.placed)
    )
    table = Table((Column("sheet", "", "the parts as they lie on it", np.ones(1)),))
    scene = Scene(table, np.zeros(1), np.ones(1, dtype=bool), bodies, cyclic=False)
    return replace(_loose(parts, scene, parts), name=parts[0].name if len(parts) == 1 else f"{len(parts)} parts")


@_job.register
def _(curve: AbstractCurve) -> Job:
    """A point that runs along it."""
    t = np.linspace(curve.breaks[0], curve.breaks[-1], FRAMES)
    place = curve.point(t)
    table = Table((
        Column("t", "", "parameter of the curve", t),
        *xy_columns("point", "mm", "place on the curve", place),
        Column("curvature", "1/mm", "curvature, positive to the left", finite(curve.curvature(t))),
        Column("speed", "mm", "way along the curve per 1 of the parameter", np.abs(curve.velocity(t))),
    ))  # fmt: skip
    scene = Scene(
        table,
        np.linspace(0, 5, FRAMES),
        np.ones(FRAMES, dtype=bool),
        (),
        (SceneCurve(curve, "construction", "curve"),),
        (SceneMark("point", place, "traced", "point", trail=True),),
        (
            Plot("curvature", ("curvature_1_per_mm",)),
            Plot("place", ("point_x_mm", "point_y_mm")),
            Plot("speed of the parameter", ("speed_mm",)),
        ),
        curve.closed,
    )
    return _loose(curve, scene)
