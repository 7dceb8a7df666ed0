"""What recipes of gears have in common: keys of helices, points that are counted before they are drawn, and notes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, ClassVar, Literal, TypeVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import WIDEST, entry
from ...core.records import record
from ...making.bases import BaseStock
from ...making.motors import MOTORS, MotorName
from ...model.check import Check
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.joined import PolarArray
from ...recipe.recipe import AbstractAssembledRecipe
from ...recipe.settings import Files
from ..contract import AbstractInvoluteGear
from ..helix import Hand, Helix, helix_angle
from ..measures import chord, over_pins, span

if TYPE_CHECKING:
    from ..pair import GearPair
    from ..planetary import PlanetarySet
    from ..rack import GearRack, RackPair
    from ..ring import RingGear
    from ..spur import SpurGear


G = TypeVar("G", "SpurGear", "RingGear", "GearRack", "PlanetarySet")
# Points of all teeth together. More take over five seconds, or a gigabyte, to write and to fill with triangles.
MOST = 200_000
# What a point round a hole takes beside one of an outline: triangles between a ring's teeth and its rim are slower.
IN_A_RING = 2
# Step from one tolerance to the next that is looked at, and how many: to a thousand times the one given.
WIDER, LOOKS = 1.25, 31
STRAIGHT = Helix()


@record(checked=True, kw_only=True)
class AbstractHelicalRecipe(AbstractAssembledRecipe):
    """What recipes of involute gears have in common."""

    advice: ClassVar[str] = (
        "If teeth lie on helices, sizes are those of the section across the axis, which drawings show; with the "
        "normal section, modules, pressure angles, profile shifts and heights are those square to the teeth."
    )

    kind: str
    helix_angle_deg: float = helix_angle()
    hand: Hand = entry(
        "hand of the helices, of gears in mesh that of the one that drives; the others follow", default="right"
    )
    herringbone: bool = entry("the upper half of the face has the other hand", default=False)
    section: Literal["transverse", "normal"] = entry(
        "the section that sizes of gears are given in: across the axis, or square to the teeth", default="transverse"
    )

    def __post_init__(self) -> None:
        self.helix  # noqa: B018  refuses a herringbone of straight teeth

    @property
    def helix(self) -> Helix:
        """Of the gear that drives."""
        return Helix(self.helix_angle_deg, self.hand, self.herringbone)

    def in_section(self, gear: G) -> G:
        """The transverse section of a gear of the recipe, whichever section its sizes are given in."""
        return gear.transverse(self.helix_angle_deg) if self.section == "normal" else gear

    @contextmanager
    def naming_section(self) -> Iterator[None]:
        """Refusals of sizes that were converted: sizes of the transverse section are in them, and what they are."""
        try:
            yield
        except DesignError as error:
            if self.section == "transverse" or not self.helix_angle_deg:
                raise
            ratio = np.cos(np.radians(self.helix_angle_deg))
            remedy = f"{error.remedy}; sizes in modules are {ratio:.6g} of the normal ones there"
            raise DesignError(error.field, f"{error.problem}, in the transverse section", remedy) from None

    @property
    def subtitle(self) -> str:
        """That of the kind, with the form of the teeth where they are not straight."""
        told = self.about()
        if not self.helix_angle_deg:
            return told
        form = "herringbone" if self.herringbone else "helical"
        if "spur gear" in told:
            return told.replace("spur gear", f"{form} gear")
        return f"{told} Its teeth are {'herringbones' if self.herringbone else form}."

    def check_faces(self, thicknesses: Mapping[str, float]) -> None:
        """Refuse a herringbone whose faces bend at different heights. thicknesses: of each stock, mm, by its key."""
        (_, first), *others = thicknesses.items()
        for key, thickness in others:
            if self.herringbone and thickness != first:
                raise DesignError(
                    f"{key}.thickness",
                    f"found {thickness:g} mm beside {first:g} mm: the two bends of a herringbone do not meet",
                    f"give {first:g} mm",
                )


def check_tooth_points(files: Files, gears: list[AbstractCurve], rings: list[AbstractCurve] | None = None) -> None:
    """Raise DesignError where outlines of gears, and holes of rings, take more points than can be drawn in time."""
    if not files.wants_parts:
        return
    weights = [(curve, 1) for curve in gears] + [(curve, IN_A_RING) for curve in rings or []]
    # What is larger than any sheet is refused for that.
    toothed = [(c, weight) for c, weight in weights if isinstance(c, PolarArray) and abs(c.point(0.0)) < WIDEST / 2]

    def points(tolerance: float) -> int:
        # Each pitch ends where the next begins.
        return sum(weight * curve.count * (len(flatten(curve.piece, tolerance)) - 1) for curve, weight in toothed)

    if (count := points(files.tolerance)) > MOST:
        teeth = sum(curve.count for curve, _ in toothed)
        raise DesignError(
            "tolerance",
            f"found {files.tolerance:g} mm, with which {teeth:,} teeth take the work of {count:,} points; "
            f"{MOST:,} can be drawn",
            # Gears of fewer teeth have more bend to each.
            _remedy(files.tolerance, points, teeth * MOST // count * 9 // 10),
        )


def _remedy(tolerance: float, points: Callable[[float], int], teeth: int) -> str:
    """The least tolerance, of some, with which so many teeth can be drawn, and the teeth that can be with this one."""
    for k in range(1, LOOKS + 1):
        wider = float(f"{tolerance * WIDER**k:.3g}")
        if points(wider) <= MOST:
            return f"give at least {wider:g} mm, or at most {teeth:,} teeth"
    return f"give at most {teeth:,} teeth"


def boss_checks(name: str, radius: float, motor: MotorName | None, base: BaseStock | None) -> tuple[Check, ...]:
    """Whether a wheel on a motor under the base rests on the base, beside the hole for the motor's boss.

    radius: mm, within which the wheel has no gaps, such as that of its roots; derived here.
    """
    if motor is None or base is None:
        return ()
    rests = radius - (MOTORS[motor].boss_diameter + base.clearance) / 2
    return (Check(f"{name} beyond the hole for the motor's boss", rests, "at least", 0, "mm", "give a larger wheel"),)


def shown(value: float) -> float:
    """A number with the digits that a summary carries."""
    return float(f"{value:.9g}")


def gear_notes(gear: AbstractInvoluteGear, helix: Helix = STRAIGHT, face_width: float = 0.0) -> Mapping[str, object]:
    """Radii and measures for the shop, mm; a measure that a gear does not have is left out.

    Radii and base pitch are those of the transverse section. face_width: mm, asked for where teeth lie on helices.
    """
    notes: dict[str, object] = {
        "teeth": gear.teeth,
        "module": shown(gear.module),
        "pressure_angle_deg": shown(np.degrees(gear.pressure_angle)),
        "profile_shift": shown(gear.profile_shift),
        "tip_radius": shown(gear.tip_radius),
        "form_radius": shown(gear.form_radius),
        "pitch_radius": shown(gear.pitch_radius),
        "base_radius": shown(gear.base_radius),
        "root_radius": shown(gear.root_radius),
        "base_pitch": shown(gear.base_pitch),
    }
    if gear.is_undercut:
        notes["share_of_involute_lost"] = shown(gear.involute_lost)
    if helix.slope:
        return {**notes, **_helical_measures(gear, helix, face_width)}
    try:
        pins = over_pins(gear)
        word = "between_pins" if gear.is_ring else "over_pins"
        notes[word] = {"pin_diameter": shown(pins.pin), "measure": shown(pins.diameter)}
    except DesignError:
        pass
    try:
        over = span(gear)
        notes["span"] = {"teeth": over.teeth, "measure": shown(over.length)}
        tooth = chord(gear)
        notes["chordal_thickness"] = {"thickness": shown(tooth.chord), "height": shown(tooth.height)}
    except DesignError:
        pass
    return notes


def _helical_measures(gear: AbstractInvoluteGear, helix: Helix, face_width: float) -> Mapping[str, object]:
    """The span, square to the teeth, where the face is wide enough for both jaws (ISO 21771)."""
    try:
        over = span(gear)
    except DesignError:
        return {}
    angle = helix.base_angle(gear)
    if over.length * np.cos(angle) * np.sin(angle) >= helix.width(face_width):
        return {}
    return {"span": {"teeth": over.teeth, "measure": shown(over.length * float(np.cos(angle)))}}


def helix_notes(gear: AbstractInvoluteGear, helix: Helix, face_width: float) -> Mapping[str, object]:
    """How the teeth of a gear lie along its face; empty for straight ones."""
    one = _helix(gear, helix, face_width)
    return {"helix": one} if one else {}


def helices_notes(sizes: Mapping[str, tuple[AbstractInvoluteGear, Helix, float]]) -> Mapping[str, object]:
    """The same of several gears by name, each with its helix and the width of its face, mm."""
    told = {name: one for name, size in sizes.items() if (one := _helix(*size))}
    return {"helix": told} if told else {}


def _helix(gear: AbstractInvoluteGear, helix: Helix, face_width: float) -> Mapping[str, object]:
    if not helix.slope:
        return {}
    return {
        "helix_angle_deg": helix.helix_angle_deg,
        "hand": helix.hand,
        "herringbone": helix.herringbone,
        "face_width_mm": face_width,
        "normal_module_mm": shown(helix.normal_module(gear.module)),
        "normal_pressure_angle_deg": shown(np.degrees(helix.normal_pressure_angle(gear))),
        "base_helix_angle_deg": shown(np.degrees(helix.base_angle(gear))),
        "normal_profile_shift": shown(gear.profile_shift / np.cos(np.radians(helix.helix_angle_deg))),
        "lead_mm": shown(helix.lead(gear)),
    }


def overlap_notes(contact_ratio: float, module: float, helix: Helix, face_width: float) -> Mapping[str, object]:
    """What helices add to the transverse contact ratio of two gears, over the face that both have; of a herringbone
    half of it. Empty for straight teeth.
    """
    if not helix.slope:
        return {}
    overlap = helix.overlap_ratio(module, face_width)
    return {"overlap_ratio": shown(overlap), "total_contact_ratio": shown(contact_ratio + overlap)}


def backlash_notes(pair: GearPair | RackPair, distance: float, helix: Helix = STRAIGHT) -> Mapping[str, object]:
    """The play of two gears, mm, and if they have none, how to give them some. distance: of the axes, mm."""
    backlash = round(pair.backlash, 9) + 0.0
    if backlash:
        return {"backlash_mm": backlash}
    # Least normal backlash of ISO/TR 10064-2, mm, for steel; along the pitch circle it is larger.
    least = 2 / 3 * (0.06 + 0.0005 * distance + 0.03 * helix.normal_module(pair.module))
    along = least / np.cos(helix.normal_pressure_angle(pair.driver)) / np.cos(np.radians(helix.helix_angle_deg))
    advice = f"teeth without backlash jam: give tooth_thickness_allowance to both gears, about {along / 2:.2f} mm each"
    return {"backlash_mm": backlash, "backlash_advice": advice}


def mesh_notes(pair: GearPair, helix: Helix = STRAIGHT, face_width: float = 0.0) -> Mapping[str, object]:
    """What two gears do together. face_width: mm, that both have; asked for where teeth lie on helices."""
    start, end = pair.contact_lengths
    return {
        "ratio": shown(pair.ratio),
        "centre_distance_mm": shown(pair.centre_distance),
        "working_pressure_angle_deg": shown(np.degrees(pair.working_pressure_angle)),
        "contact_ratio": shown(pair.contact_ratio),
        **overlap_notes(pair.contact_ratio, pair.module, helix, face_width),
        **backlash_notes(pair, pair.centre_distance, helix),
        "clearances_mm": [shown(c) for c in pair.clearances],
        "largest_specific_sliding": [shown(float(pair.sliding(start)[0])), shown(float(pair.sliding(end)[1]))],
        "interferences": list(pair.interferences),
    }
