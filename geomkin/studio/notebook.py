"""Animated pages of mechanisms in a notebook, with the same scene and page as a recipe."""

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
from ..core.names import PathName
from ..core.records import record
from ..core.units import mm
from ..export.job import Job, StaticSource
from ..export.summary import write_whole
from ..gear.checks import mesh_checks
from ..gear.contract import AbstractGear
from ..gear.kinds.gears import PlanetaryRecipe, RingGearRecipe, SpurGearRecipe
from ..gear.pair import GearPair
from ..gear.parts import GearStock, RingStock, gear_parts
from ..gear.planetary import PlanetarySet
from ..gear.rack import RackPair
from ..gear.ring import RingGear
from ..gear.scene_pairs import pair_scene
from ..gear.spur import SpurGear
from ..linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG, linkage_checks
from ..linkage.drive_limits import TURN, driver_limits
from ..linkage.linkage import AbstractLinkage
from ..linkage.motion import Motion, motion_table
from ..linkage.moving import move
from ..linkage.scene import linkage_scene, motion_plots
from ..linkage.solve.branch import Branch
from ..model.check import Check
from ..model.part import Part
from ..model.scene import Limit, Plot, Scene, SceneBody, SceneCurve, SceneMark
from ..model.table import Column, Table, finite, xy_columns
from ..page.page import mechanism_page
from ..plane.curve import AbstractCurve, extent
from ..recipe.load import to_toml
from ..recipe.recipe import AbstractRecipe
from ..recipe.settings import Files
from ..recipe.shown import ShownRecipe
from ..synthesis.found import Found

# Height of the frame, pixels: drawing, controls and plots are visible at once, the rest by scrolling. The user can
# resize it.
FRAME_HEIGHT = 660
# Frames of a full turn, both ends included; a range between limits has half as many.
FRAMES = 361
# Share of a range between limits that is omitted at each end, since rates are infinite at the limits. With a larger
# value the picture visibly stops before the limit.
END_MARGIN = 1e-3
# Chord tolerance of parts in a picture: as a share of the smallest part's size, and at least as a share of the largest.
FINE, FINEST = 1e-3, 2e-7


@record(eq=False)
class Shown:
    """An animated page, which a notebook displays at the end of a cell.

    Parameters
    ----------
    name : str
        Title of the page.
    page : bytes
        The HTML page, UTF-8.
    """

    name: str
    page: bytes

    def __repr__(self) -> str:
        return f"Shown({printable(self.name, 60)}: a page of {len(self.page) / 1000:.0f} kB; save(path) writes it)"

    def _repr_html_(self) -> str:
        """The page in a sandboxed frame, isolated from the notebook."""
        html = escape(self.page.decode("utf-8"))
        style = f"width:100%;height:{FRAME_HEIGHT}px;border:0;resize:vertical;overflow:auto"
        sandbox = 'sandbox="allow-scripts allow-downloads"'
        return f'<iframe title="{escape(self.name)}" {sandbox} style="{style}" srcdoc="{html}"></iframe>'

    @checked
    def save(self, path: PathName) -> Path:
        """Write the page to a file, which opens in any browser.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        FileError
            If the file cannot be written.
        """
        path = Path(path)
        write_whole(path.parent, {path.name: self.page})
        return path


def _is_showable(value: Any) -> bool:
    if isinstance(value, (tuple, list)):
        return bool(value) and all(isinstance(item, Part) for item in value)
    return _job.dispatch(type(value)) is not _job.dispatch(object)


SHOWABLE = ArgumentType(
    _is_showable,
    "a recipe, its file or text, a linkage, a motion, a cam, a gear, a pair of gears, a planetary set, a part or "
    "several, a curve, or a linkage that a synthesis found",
)
Showable = Annotated[Any, SHOWABLE]


@checked
def show(thing: Showable) -> Shown:
    """Show a mechanism as an animated page in a notebook.

    Parameters
    ----------
    thing : recipe, str, Path, mapping, or any object of this library that can be drawn
        - A recipe, or its file or text: its own page.
        - A linkage: driven over a full turn at 60 rpm, or between the limits of its driver, on branch +1. For another
          range or branch, show `move(...)`.
        - A linkage found by a synthesis: driven over a full turn, or over all wanted positions.
        - A cam, a gear, a gear pair or a planetary set: a cam turns under its follower, gears turn in mesh or under
          their cutting tool.
        - A curve: a point moves along it at a constant rate of the parameter.
        - A part or several: arranged on their sheet.

        Links without a stock are shown as lines; cams and rings have plates of a suitable size.

    Returns
    -------
    Shown
        The page; `save(path)` writes it.

    Raises
    ------
    DesignError
        If the object has no picture or cannot move.
    RecipeError, FileError
        If a recipe or its file cannot be read.

    See Also
    --------
    edit, make

    Examples
    --------
    >>> gk.show(gk.FourBar(100, 30, 90, 70)).name
    'FourBar'
    """
    job = _job(thing)
    return Shown(job.name, mechanism_page(job))


def inline(thing: object) -> str:
    """HTML of an object for a notebook; if there is nothing to show, the reason."""
    try:
        return show(thing)._repr_html_()
    except GeomkinError as error:
        return f"<pre>{escape(repr(thing))}\n{escape(str(error))}</pre>"


@singledispatch
def _job(thing: object) -> Job:
    """The content of an object's page."""
    raise refused("thing", thing, SHOWABLE)


def _static_job(
    thing: object, scene: Scene, parts: Sequence[Part] = (), checks: Sequence[Check] = (), about: str = ""
) -> Job:
    return Job(type(thing).__name__, StaticSource(tuple(parts), scene.table, scene, tuple(checks)), 1.0, about=about)


@_job.register
def _(recipe: AbstractRecipe) -> Job:
    name = recipe.name or recipe.kind
    if recipe.scene is None:
        return replace(_job(recipe.parts), name=name)
    shown, text = ShownRecipe(recipe), partial(to_toml, recipe)
    return Job(name, shown, recipe.files.tolerance, about=shown.introduction, recipe=text, unit=shown.unit)


@_job.register(str)
@_job.register(Path)
@_job.register(Mapping)
def _(source: str | Path | Mapping[str, Any]) -> Job:
    return _job(load(source))


@_job.register
def _(motion: Motion) -> Job:
    least = LEAST_TRANSMISSION_ANGLE_DEG
    table, limit = motion_table(motion), Limit("transmission_angle", least, f"at least {least:g} deg")
    scene = linkage_scene(motion, table, plots=motion_plots(motion, table, [limit]))
    return _static_job(motion, scene, (), linkage_checks(motion))


@_job.register
def _(linkage: AbstractLinkage) -> Job:
    return _moved(linkage, 1, None)


@_job.register
def _(found: Found) -> Job:
    return _moved(found.linkage, found.branch, (float(np.min(found.drive)), float(np.max(found.drive))))


def _moved(linkage: AbstractLinkage, branch: Branch, wanted: tuple[float, float] | None) -> Job:
    """A linkage over a full turn, over the range `wanted`, or between its limits."""
    if linkage.linkage.is_batch:
        raise DesignError("thing", "found an array of linkages", "give one at a time", "wrong-type")
    slides = linkage.linkage.driven_slider is not None
    limits: tuple[tuple[float, float], ...] = ()
    try:
        limits = driver_limits(linkage, branch)
    except DesignError as error:
        if wanted is None:
            raise DesignError(
                "thing", error.problem, "show its motion over the range you want instead: move(...)", error.id
            ) from None
    if limits == (TURN,):
        drive = np.linspace(*TURN, FRAMES)
    else:
        drive = np.linspace(*(_widest_range(limits, slides) if wanted is None else wanted), FRAMES // 2 + 1)
    speed = float(np.ptp(drive)) if slides else 2 * np.pi
    about = f"Driven at {mm(speed, unit='mm/s'):.3g}." if slides else "Driven at 60 rpm."
    return replace(_job(move(linkage, drive, branch, speed or 1.0)), name=type(linkage).__name__, about=about)


def _widest_range(limits: Sequence[tuple[float, float]], slides: bool) -> tuple[float, float]:
    """The widest range between two limits, without a small margin at each end."""
    if not limits:
        raise DesignError("thing", "it cannot be assembled in any position", "change its lengths", "does-not-assemble")
    spans = list(limits)
    (first, *_), (last, *_) = spans[0], spans[-1]
    if not slides and len(spans) > 1 and first == TURN[0] and spans[-1][1] == TURN[1]:
        # One range that contains the start of the turn.
        spans = [(last - TURN[1], spans[0][1]), *spans[1:-1]]
    low, high = max(spans, key=lambda span: span[1] - span[0])
    return low + END_MARGIN * (high - low), high - END_MARGIN * (high - low)


@_job.register
def _(cam: Cam) -> Job:
    # Plates in proportion to the cam, without holes, whose sizes are not given.
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
    """Tolerance in proportion to the gear; no files are written."""
    return Files(tolerance=float(np.clip(1e-4 * radius, 1e-6, 10)))


@_job.register
def _(pair: GearPair | RackPair) -> Job:
    gears: dict[str, AbstractGear] = dict(zip(pair.names, (pair.driver, pair.driven)))
    parts = [part for name, gear in gears.items() for part in _plate(gear, name)]
    return _static_job(pair, replace(pair_scene(pair, parts)), parts, mesh_checks(pair))


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
    """Parts arranged on their sheet."""
    sizes = [extent(part.outline) for part in parts]
    tolerance = max(FINE * min(sizes), FINEST * max(sizes))
    sheet = Job("parts", StaticSource(tuple(parts)), tolerance).sheets[0]
    unit = np.ones(1, dtype=complex)
    names = [placed.cut.part.name for placed in sheet.placed]
    labels = [f"{name} {names[:k].count(name) + 1}" if names.count(name) > 1 else name for k, name in enumerate(names)]
    bodies = tuple(
        SceneBody(name, (placed.cut.part,), placed.shift * unit, placed.turn * unit)
        for name, placed in zip(labels, sheet.placed)
    )
    table = Table((Column("sheet", "", "parts on the sheet", np.ones(1)),))
    scene = Scene(table, np.zeros(1), np.ones(1, dtype=bool), bodies, cyclic=False)
    return replace(_static_job(parts, scene, parts), name=parts[0].name if len(parts) == 1 else f"{len(parts)} parts")


@_job.register
def _(curve: AbstractCurve) -> Job:
    """A point that moves along the curve."""
    t = np.linspace(curve.breaks[0], curve.breaks[-1], FRAMES)
    point = curve.point(t)
    table = Table((
        Column("t", "", "parameter of the curve", t),
        *xy_columns("point", "mm", "point on the curve", point),
        Column("curvature", "1/mm", "curvature, positive to the left", finite(curve.curvature(t))),
        Column("speed", "mm", "length along the curve per unit of the parameter", np.abs(curve.velocity(t))),
    ))  # fmt: skip
    scene = Scene(
        table,
        np.linspace(0, 5, FRAMES),
        np.ones(FRAMES, dtype=bool),
        (),
        (SceneCurve(curve, "construction", "curve"),),
        (SceneMark("point", point, "traced", "point", trail=True),),
        (
            Plot("curvature", ("curvature",)),
            Plot("position", ("point_x", "point_y")),
            Plot("speed of the parameter", ("speed",)),
        ),
        curve.closed,
    )
    return _static_job(curve, scene)
