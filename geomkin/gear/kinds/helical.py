"""Shared parts of gear recipes: keys of helices, the limit of points, and notes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, WIDEST, entry, quantity, to_digits
from ...core.records import record
from ...core.units import UNITS, Sentence, bare_mm, marked, mm, unit_name
from ...making.assembly import BaseStock
from ...making.attachments import Attachment
from ...making.motors import MountedMotorKey, face_of
from ...model.check import Check
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.joined import PolarArray
from ...plane.vec import without_rounding
from ...recipe.recipe import AbstractAssembledRecipe, Additions
from ...recipe.settings import Files
from ..contract import AbstractInvoluteGear, Hand, Helix, helix_angle
from ..measures import chord, over_pins, over_stock_pins, span
from ..parts import RingStock
from ..ring import RingGear

if TYPE_CHECKING:
    from ..pair import GearPair
    from ..planetary import PlanetarySet
    from ..rack import GearRack, RackPair
    from ..spur import SpurGear


G = TypeVar("G", "SpurGear", "RingGear", "GearRack", "PlanetarySet")
# Limit of points of all teeth together. More need over five seconds, or a gigabyte, for writing and triangulation.
MOST = 200_000
# Weight of a point of a ring: triangulation between its teeth and its rim is slower than of an outline.
RING_WEIGHT = 2
# Factor between trial tolerances, and their number: up to a thousand times the given one.
WIDER, TRIALS = 1.25, 31
STRAIGHT = Helix()
# Backlash above which profile shifts are advised, modules; gears usually have a third of it.
MUCH_BACKLASH = 0.1
Tips = Literal["given", "full-clearance"]


def tips_entry() -> Any:
    """The field `tips`."""
    meaning = "tips as the addenda give them, or shortened to the full clearance of the tools"
    return entry(meaning, default="given")


def friction_entry() -> Any:
    """The field `friction`."""
    meaning = (
        "mean coefficient of friction of the flanks, for the efficiency, by which the torque in a machine is larger"
    )
    return quantity(meaning, default=0.0, at_least=0, at_most=1)


# An example of what is attached to a ring of the default rim: its screws are in the middle of that of the example ring.
ON_RING = Attachment("bracket", bolts=3, bolt_circle=133.0, screw=2.0)


def on_ring(tables: Mapping[str, str], key: str = "ring_stock.attachments") -> dict[str, object]:
    """This example by its key, if a template has it."""
    return {key: ON_RING} if key in tables else {}


class RingAdditions(Additions):
    """Additions to a recipe with a ring: what is attached to the ring has its screws in the middle of the rim."""

    def changes(self, recipe: Any, key: str) -> Iterator[Mapping[str, Any]]:
        stock, _, name = key.rpartition(".")
        table = getattr(recipe, stock, None)
        if name == "attachments" and isinstance(table, RingStock):
            design, unit = recipe.design, UNITS[recipe.units]
            gears = (design, getattr(design, "second", None), getattr(design, "ring", None))
            ring = next(gear for gear in gears if isinstance(gear, RingGear))
            circle, screw = 2 * ring.root_radius + table.rim, min(ON_RING.screw, table.rim / 4)
            sizes = {"bolt_circle": circle, "screw": screw}
            sizes = {size: to_digits(unit.of(length), 6) for size, length in sizes.items()}
            yield {f"{key}[{len(table.attachments)}]": {"name": ON_RING.name, "bolts": ON_RING.bolts, **sizes}}


# Least efficiency of gears in a machine: with less, friction locks them.
LEAST_EFFICIENCY = 1e-3


@record(checked=True, kw_only=True)
class AbstractHelicalRecipe(AbstractAssembledRecipe):
    """Base class of recipes of involute gears."""

    advice: ClassVar[str] = (
        "All reported sizes of helical teeth refer to the transverse section, which drawings show. If the recipe's "
        "section is normal, its modules, pressure angles, profile shifts and heights refer to the normal section."
    )

    kind: str
    helix_angle_deg: float = helix_angle()
    hand: Hand = entry("hand of the helices of the driving gear; the others follow", default="right")
    herringbone: bool = entry("whether the upper half of the face has the other hand", default=False)
    section: Literal["transverse", "normal"] = entry(
        "section to which sizes of gears refer: perpendicular to the axis, or to the teeth", default="transverse"
    )

    if TYPE_CHECKING:
        # Declared for the type checker only, since the order of fields is that of their first declaration.
        measuring: Measuring | None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.helix  # noqa: B018  raises for a herringbone with straight teeth

    @property
    def helix(self) -> Helix:
        """Helix of the driving gear."""
        return Helix(self.helix_angle_deg, self.hand, self.herringbone)

    def in_section(self, gear: G) -> G:
        """The transverse section of a gear of the recipe."""
        return gear.transverse(self.helix_angle_deg) if self.section == "normal" else gear

    @contextmanager
    def naming_section(self) -> Iterator[None]:
        """Add to a DesignError for converted sizes that its sizes refer to the transverse section."""
        try:
            yield
        except DesignError as error:
            if self.section == "transverse" or not self.helix_angle_deg:
                raise
            ratio = np.cos(np.radians(self.helix_angle_deg))
            remedy = f"{marked(error.remedy)}; sizes in modules are {ratio:.6g} of the normal ones there"
            problem = f"{marked(error.problem)}, in the transverse section"
            raise DesignError(error.field, problem, remedy, error.id) from None

    @property
    def subtitle(self) -> str:
        """The introduction of the kind, with the form of helical teeth."""
        about = self.about()
        if not self.helix_angle_deg:
            return about
        form = "herringbone" if self.herringbone else "helical"
        if "spur gear" in about:
            return about.replace("spur gear", f"{form} gear")
        return f"{about} Its teeth are {'herringbones' if self.herringbone else form}."

    def mesh_notes(
        self, meshes: Mapping[str, object], sizes: Mapping[str, tuple[AbstractInvoluteGear, Helix, float]]
    ) -> Mapping[str, object]:
        """Notes of gears in mesh. sizes: gear, helix and face width, mm, by name."""
        measures = {name: gear_notes(*size, self.measuring) for name, size in sizes.items()}
        return {**meshes, **helices_notes(sizes), "measures_mm": measures}

    def check_faces(self, thicknesses: Mapping[str, float]) -> None:
        """Refuse a herringbone whose gears reverse at different heights. thicknesses: of each stock by key, mm."""
        (_, first), *others = thicknesses.items()
        for key, thickness in others:
            if self.herringbone and thickness != first:
                raise DesignError(
                    f"{key}.thickness",
                    f"found {mm(thickness):g}, but the first gear has {mm(first):g}; herringbones need equal faces",
                    f"give {mm(first):.15g}",
                    "conflict",
                    first,
                )


def check_tooth_points(files: Files, gears: list[AbstractCurve], rings: list[AbstractCurve] | None = None) -> None:
    """Raise DesignError if outlines of gears and rings have too many points to write within seconds."""
    if not files.wants_parts:
        return
    weights = [(curve, 1) for curve in gears] + [(curve, RING_WEIGHT) for curve in rings or []]
    # Gears larger than any sheet are refused elsewhere.
    toothed = [(c, weight) for c, weight in weights if isinstance(c, PolarArray) and abs(c.point(0.0)) < WIDEST / 2]

    def points(tolerance: float) -> int:
        # Adjacent pitches share a point.
        return sum(weight * curve.count * (len(flatten(curve.piece, tolerance)) - 1) for curve, weight in toothed)

    if (count := points(files.tolerance)) > MOST:
        teeth = sum(curve.count for curve, _ in toothed)
        raise DesignError(
            "tolerance",
            f"found {mm(files.tolerance):g}, for which {teeth:,} teeth count as {count:,} points; the limit is "
            f"{MOST:,}",
            # With fewer teeth, each has more curvature.
            _remedy(files.tolerance, points, teeth * MOST // count * 9 // 10),
            "too-much-work",
        )


def _remedy(tolerance: float, points: Callable[[float], int], teeth: int) -> str:
    """A remedy: the least trial tolerance within the limit of points, or the number of teeth for this tolerance."""
    for k in range(1, TRIALS + 1):
        wider = to_digits(tolerance * WIDER**k, 3)
        if points(wider) <= MOST:
            return f"give at least {mm(wider):up6}, or at most {teeth:,} teeth"
    return f"give at most {teeth:,} teeth"


def boss_checks(name: str, radius: float, motor: MountedMotorKey | None, base: BaseStock | None) -> tuple[Check, ...]:
    """Check that a wheel on a motor under the base rests on the base, outside the hole for the motor's boss.

    radius: of the wheel's solid part, such as the root radius, mm. Derived here.
    """
    if motor is None or base is None:
        return ()
    rests = without_rounding(radius - (face_of(motor).boss_diameter + base.clearance) / 2, radius)
    words = f"{name} beyond the hole for the motor's boss"
    return (Check(f"{name}_beyond_boss_hole", words, rests, "at least", 0, "mm", "give a larger wheel"),)


@record(checked=True, kw_only=True)
class Measuring:
    """How the teeth are measured; the measures are in the drawing and in the summary."""

    pin_diameter: float | None = quantity(
        "diameter of the measuring pins; if omitted, and for gears that it does not fit, the nearest usual one",
        "mm", default=None, above=0, at_most=FARTHEST,
    )  # fmt: skip
    thickness_tolerance: float = quantity(
        "how much thinner teeth may be than designed, along the pitch circle in the transverse section",
        "mm", default=0.0, at_least=0, at_most=FARTHEST, example=0.05,
    )  # fmt: skip


def measuring_entry() -> Any:
    """The field `measuring`."""
    return entry("pins and tolerance by which the teeth are measured", default=None)


def gear_notes(
    gear: AbstractInvoluteGear, helix: Helix = STRAIGHT, face_width: float = 0.0, measuring: Measuring | None = None
) -> Mapping[str, object]:
    """Radii and measures of a gear, mm, in the transverse section; measures that do not exist are omitted.

    face_width: mm, used for helical teeth.
    """
    tool: Any = getattr(gear, "cutter", None) or getattr(gear, "rack", None)
    notes: dict[str, object] = {
        "teeth": gear.teeth,
        "module": to_digits(gear.module),
        "pressure_angle_deg": to_digits(np.degrees(gear.pressure_angle)),
        "profile_shift": to_digits(gear.profile_shift),
        "tip_radius": to_digits(gear.tip_radius),
        "form_radius": to_digits(gear.form_radius),
        "pitch_radius": to_digits(gear.pitch_radius),
        "base_radius": to_digits(gear.base_radius),
        "root_radius": to_digits(gear.root_radius),
        "base_pitch": to_digits(gear.base_pitch),
        "tooth_thickness": to_digits(gear.thickness(gear.pitch_radius)),
        "tool_tip_radius": to_digits(tool.tip_radius * gear.module),
        **({"tool_fillet_radius": to_digits(tool.fillet_radius * gear.module)} if tool.fillet_radius else {}),
        **({"tool_teeth": tool.teeth, "tool_profile_shift": tool.profile_shift} if gear.is_ring else {}),
    }
    for name in ("tip_rounding", "tip_chamfer"):
        if size := getattr(gear, name, 0.0):
            notes[name] = to_digits(size)
    if gear.is_undercut:
        notes["share_of_involute_lost"] = to_digits(gear.involute_lost)
    given = measuring or Measuring()
    if helix.slope:
        return {**notes, **_helical_measures(gear, helix, face_width, given.thickness_tolerance)}
    try:
        pins = over_stock_pins(gear, given.pin_diameter)
        sizes = {"pin_diameter": to_digits(pins.pin), "measure": to_digits(pins.diameter)}
        if given.thickness_tolerance:
            nominal: Any = gear
            allowance = nominal.tooth_thickness_allowance + given.thickness_tolerance
            thin = replace(nominal, tooth_thickness_allowance=allowance)
            sizes["tolerance"] = to_digits(over_pins(thin, pins.pin).diameter - pins.diameter)
        notes["between_pins" if gear.is_ring else "over_pins"] = sizes
    except DesignError:
        pass
    try:
        over = span(gear)
        notes["span"] = _span_notes(gear, over.teeth, over.length, given.thickness_tolerance)
        tooth = chord(gear)
        notes["chordal_thickness"] = {"thickness": to_digits(tooth.chord), "height": to_digits(tooth.height)}
    except DesignError:
        pass
    return notes


def _span_notes(gear: AbstractInvoluteGear, teeth: int, length: float, tolerance: float) -> Mapping[str, object]:
    """A span, and by how much it is shorter for the thinnest teeth, mm; tolerance: of the thickness in its section."""
    less = {"tolerance": to_digits(-tolerance * float(np.cos(gear.pressure_angle)))} if tolerance else {}
    return {"teeth": teeth, "measure": to_digits(length), **less}


def _helical_measures(
    gear: AbstractInvoluteGear, helix: Helix, face_width: float, tolerance: float
) -> Mapping[str, object]:
    """The span perpendicular to the teeth, if the face is wide enough for both jaws (ISO 21771)."""
    try:
        over = span(gear)
    except DesignError:
        return {}
    angle = helix.base_angle(gear)
    if over.length * np.cos(angle) * np.sin(angle) >= helix.width(face_width):
        return {}
    normal = float(np.cos(angle))
    return {"span": _span_notes(gear, over.teeth, over.length * normal, tolerance * normal)}


def helix_notes(gear: AbstractInvoluteGear, helix: Helix, face_width: float) -> Mapping[str, object]:
    """The helix of a gear; empty for straight teeth."""
    notes = _helix(gear, helix, face_width)
    return {"helix": notes} if notes else {}


def helices_notes(sizes: Mapping[str, tuple[AbstractInvoluteGear, Helix, float]]) -> Mapping[str, object]:
    """The helices of several gears by name, each given with its helix and face width, mm."""
    helices = {name: notes for name, size in sizes.items() if (notes := _helix(*size))}
    return {"helix": helices} if helices else {}


def _helix(gear: AbstractInvoluteGear, helix: Helix, face_width: float) -> Mapping[str, object]:
    if not helix.slope:
        return {}
    return {
        "helix_angle_deg": helix.helix_angle_deg,
        "hand": helix.hand,
        "herringbone": helix.herringbone,
        "face_width_mm": face_width,
        "normal_module_mm": to_digits(helix.normal_module(gear.module)),
        "normal_pressure_angle_deg": to_digits(np.degrees(helix.normal_pressure_angle(gear))),
        "base_helix_angle_deg": to_digits(np.degrees(helix.base_angle(gear))),
        "normal_profile_shift": to_digits(gear.profile_shift / np.cos(np.radians(helix.helix_angle_deg))),
        "lead_mm": to_digits(helix.lead(gear)),
    }


def overlap_notes(contact_ratio: float, module: float, helix: Helix, face_width: float) -> Mapping[str, object]:
    """Overlap ratio and total contact ratio of two helical gears over their common face; empty for straight teeth."""
    if not helix.slope:
        return {}
    overlap = helix.overlap_ratio(module, face_width)
    return {"overlap_ratio": to_digits(overlap), "total_contact_ratio": to_digits(contact_ratio + overlap)}


def least_backlash(distance: float, module: float) -> float:
    """Least normal backlash by ISO/TR 10064-2, mm, for steel, from the distance of the axes and the normal module."""
    return 2 / 3 * (0.06 + 0.0005 * distance + 0.03 * module)


def backlash_notes(pair: GearPair | RackPair, distance: float, helix: Helix = STRAIGHT) -> Mapping[str, object]:
    """Backlash of two gears, mm, and advice if there is none. distance: of the axes, mm."""
    backlash = round(pair.backlash, 9) + 0.0
    if backlash:
        return {"backlash_mm": backlash}
    # Along the pitch circle it is larger.
    least = least_backlash(distance, helix.normal_module(pair.module))
    along = least / np.cos(helix.normal_pressure_angle(pair.driver)) / np.cos(np.radians(helix.helix_angle_deg))
    advice = f"teeth without backlash jam: give tooth_thickness_allowance to both gears, about {mm(along / 2):.2f} each"
    return {"backlash_mm": backlash, "backlash_advice": advice}


def backlash_remarks(notes: Mapping[str, object]) -> tuple[str, ...]:
    """Advice on backlash as sentences: that of each mesh, under the mesh's name if there are several."""
    key = "backlash_advice"
    meshes = {"pair": notes, **{name: entries for name, entries in notes.items() if isinstance(entries, Mapping)}}
    advice = {name: marked(entries[key]) for name, entries in meshes.items() if key in entries}
    named = (text if name == "pair" else f"{name.replace('_', ' ')}: {text}" for name, text in advice.items())
    return tuple(f"{text[0].upper()}{text[1:]}." for text in named)


def _shift_advice(pair: GearPair, helix: Helix) -> Mapping[str, object]:
    """The profile shifts that leave the backlash of the allowances alone, if there is more; empty for helical teeth."""
    meant = pair.first.tooth_thickness_allowance + pair.second.tooth_thickness_allowance
    if helix.slope or pair.backlash - meant <= MUCH_BACKLASH * pair.module:
        return {}
    relation = "ring's profile shift minus the pinion's" if pair.is_internal else "sum of both profile shifts"
    # Rounded so that the teeth do not jam: those of a ring come closer with less shift, those of other pairs with more.
    rounded = np.ceil if pair.is_internal else np.floor
    shift = rounded(1000 * pair.shift_without_backlash) / 1000
    rest = " but that of the allowances" if meant else ""
    return {"backlash_advice": f"no backlash{rest} is left at this distance if the {relation} is {shift:g}"}


def pair_quantities(pair: GearPair) -> dict[str, str]:
    """Ratio, centre distance, working pressure angle, contact ratio and backlash, by label."""
    of_distance = f"for 1 {unit_name()} of centre distance"
    ratio_rate, backlash_rate = (pair.sensitivity(of, by="centre_distance") for of in ("contact_ratio", "backlash"))
    return {
        "ratio": f"{pair.ratio:.5g}",
        "centre distance": Sentence(f"{mm(pair.centre_distance):.6g}"),
        "working pressure angle": f"{np.degrees(pair.working_pressure_angle):.4g} deg",
        "contact ratio": Sentence(f"{pair.contact_ratio:.4g}, and {bare_mm(ratio_rate, power=-1):+.3g} {of_distance}"),
        "backlash": Sentence(
            f"{mm(round(pair.backlash, 6)):.4g}, and {backlash_rate:+.3g} {unit_name()} {of_distance}"
        ),
    }


def gear_quantities(gear: AbstractInvoluteGear, name: str) -> dict[str, str]:
    """Diameters of pitch, tip and root circle, by label."""
    diameters = (2 * radius for radius in (gear.pitch_radius, gear.tip_radius, gear.root_radius))
    return {f"pitch, tip and root diameter of the {name}": Sentence(f"{mm(*diameters):.4g}")}


def mesh_notes(pair: GearPair, helix: Helix = STRAIGHT, face_width: float = 0.0) -> Mapping[str, object]:
    """Data of two gears in mesh. face_width: common to both, mm, used for helical teeth."""
    start, end = pair.contact_lengths
    return {
        "ratio": to_digits(pair.ratio),
        "centre_distance_mm": to_digits(pair.centre_distance),
        "working_pressure_angle_deg": to_digits(np.degrees(pair.working_pressure_angle)),
        "contact_ratio": to_digits(pair.contact_ratio),
        **overlap_notes(pair.contact_ratio, pair.module, helix, face_width),
        **backlash_notes(pair, pair.centre_distance, helix),
        **_shift_advice(pair, helix),
        "clearances_mm": [to_digits(c) for c in pair.clearances],
        "largest_specific_sliding": [to_digits(float(pair.sliding(start)[0])), to_digits(float(pair.sliding(end)[1]))],
        "interferences": list(pair.interferences),
    }
