"""What a summary tells of gears besides their parts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..errors import DesignError
from ..gear.contract import AbstractInvoluteGear
from ..gear.helix import Helix
from ..gear.measures import chord, over_pins, span
from ..gear.pair import GearPair

STRAIGHT = Helix()


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


def mesh_notes(pair: GearPair, helix: Helix = STRAIGHT, face_width: float = 0.0) -> Mapping[str, object]:
    """What two gears do together. face_width: mm, that both have; asked for where teeth lie on helices."""
    start, end = pair.contact_lengths
    return {
        "centre_distance_mm": shown(pair.centre_distance),
        "working_pressure_angle_deg": shown(np.degrees(pair.working_pressure_angle)),
        "contact_ratio": shown(pair.contact_ratio),
        **overlap_notes(pair.contact_ratio, pair.module, helix, face_width),
        "backlash_mm": round(pair.backlash, 9) + 0.0,
        "clearances_mm": [shown(c) for c in pair.clearances],
        "largest_specific_sliding": [shown(float(pair.sliding(start)[0])), shown(float(pair.sliding(end)[1]))],
        "interferences": list(pair.interferences),
    }
