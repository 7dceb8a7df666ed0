"""Recipes of gears whose teeth lie on helices: results, hands and refusals."""

import numpy as np
import pytest

import geomkin as gk
from tests.texts import parse

SPUR = 'kind = "spur-gear"\nhelix_angle_deg = 30\nhand = "left"\n'
PAIR = 'kind = "gear-pair"\nhelix_angle_deg = 20\n'
SUN = "sun = { teeth = 24, module = 2 }\nplanet = { teeth = 18, module = 2 }\n"
RING = "ring = { teeth = 60, module = 2, addendum = 0.8 }\n"


def turns(recipe):
    """Turn of the top of each gear times its pitch radius, mm, and the slide of a rack."""
    pitch = {"first": 18, "second": 36, "pinion": 20, "rack": 1, "sun": 24, "planet": 18, "ring": 60}
    return {p.name: p.twist.turn * pitch[p.name] + p.twist.shift for p in recipe.parts if p.twist}


@pytest.mark.parametrize(
    ("text", "signs"),
    [
        (PAIR, {"first": 1, "second": -1}),
        (PAIR + 'hand = "left"\n', {"first": -1, "second": 1}),
        ('kind = "rack-and-pinion"\nhelix_angle_deg = 20\n', {"pinion": 1, "rack": 1}),
        (f'kind = "planetary"\nhelix_angle_deg = 20\n[gears]\n{SUN}{RING}', {"sun": 1, "planet": -1, "ring": -1}),
    ],
)
def test_teeth_in_mesh_get_as_far_along_the_pitch_circle(text, signs):
    if "pair" in text:
        text += "first = { teeth = 12, module = 3 }\nsecond = { teeth = 24, module = 3 }\n"
    if "rack" in text:
        text += "pinion = { teeth = 20, module = 2 }\nrack = { teeth = 9, module = 2 }\n"
    found, way = turns(parse(text)), 6 * np.tan(np.radians(20))
    assert found == pytest.approx({name: sign * way for name, sign in signs.items()})


def test_the_span_is_that_of_the_normal_system():
    """W = m_n cos(a_n) ((k - 1/2) pi + z inv(a_t)) + 2 x_n m_n sin(a_n) (ISO 21771)."""
    text = SPUR + "gear = { teeth = 24, module = 3, profile_shift = 0.2 }\nstock = { thickness = 25 }\n"
    notes = parse(text).notes
    transverse, normal = np.radians(20), np.radians(notes["helix"]["normal_pressure_angle_deg"])
    span, module = notes["measures_mm"]["span"], notes["helix"]["normal_module_mm"]
    inv = np.tan(transverse) - transverse
    plain = module * np.cos(normal) * ((span["teeth"] - 0.5) * np.pi + 24 * inv)
    assert span["measure"] == pytest.approx(plain + 2 * 0.2 * 3 * np.sin(normal))
    assert not {"over_pins", "chordal_thickness"} & set(notes["measures_mm"])
    # Jaws do not reach over a face that is narrower than the span leans.
    narrow = parse(text.replace("25", "4")).notes["measures_mm"]
    assert "span" not in narrow


def test_a_herringbone_bends_where_its_mate_does():
    teeth = (
        "first = { teeth = 12, module = 3 }\nsecond = { teeth = 24, module = 3 }\nsecond_stock = { thickness = 8 }\n"
    )
    with pytest.raises(gk.RecipeError, match="second_stock.thickness:"):
        parse(PAIR + "herringbone = true\n" + teeth)
    assert parse(PAIR + teeth).parts


@pytest.mark.parametrize("faces", [(6, 8, 5), (8, 5, 6), (5, 6, 8), (8, 6, 5)])
def test_each_mesh_of_a_planetary_set_overlaps_over_the_face_that_both_have(faces):
    stocks = "\n".join(
        f"{name}_stock.thickness = {face}" for name, face in zip(("sun", "planet", "ring"), faces, strict=True)
    )
    recipe = parse(f'kind = "planetary"\nhelix_angle_deg = 20\n{stocks}\n[gears]\n{SUN}{RING}')
    found = {
        name: reported["overlap_ratio"]
        for name, reported in recipe.notes.items()
        if "overlap_ratio" in str(reported) and "overlap_ratio" in reported
    }
    sun, planet, ring = faces
    # One flank is ahead of itself by so much of a pitch along the circle where it is over.
    pitches = {
        name: face * np.tan(np.radians(20)) / (2 * np.pi)
        for name, face in (("sun_and_planet", min(sun, planet)), ("planet_and_ring", min(planet, ring)))
    }
    assert found == pytest.approx(pitches, rel=1e-8)
