"""What a workshop measures, against calipers laid on the finished outline."""

import numpy as np
import pytest

import geomkin as gk

GEARS = [
    gk.SpurGear(20, 2),
    gk.SpurGear(31, 2, 0.4),
    gk.SpurGear(12, 2, 0.3),
    gk.SpurGear(40, 2, -0.3, tooth_thickness_allowance=0.1),
]
RINGS = [gk.RingGear(60, 2), gk.RingGear(41, 2, 0.5), gk.RingGear(60, 2, tooth_thickness_allowance=0.2)]


def ids(gear):
    return f"{type(gear).__name__} {gear.teeth}"


@pytest.mark.parametrize("gear", GEARS, ids=ids)
def test_the_span_is_the_width_of_the_teeth_between_parallel_jaws(gear):
    """The extent of the flanks of k teeth of the outline, roots left out, across their middle line."""
    outline = gk.flatten(gear.outline, 1e-5)
    found = gk.gear.span(gear)
    for teeth in (found.teeth - 1, found.teeth):
        z = outline * np.exp(-1j * np.pi * (teeth - 1) / gear.teeth)  # the teeth from +y on, their middle on +y
        flanks = z[np.abs(z) > gear.form_radius * (1 + 1e-9)]
        kept = flanks[np.abs(np.angle(flanks / 1j)) < np.pi * teeth / gear.teeth]
        assert np.ptp(kept.real) == pytest.approx(gk.gear.span(gear, teeth).length, abs=1e-4)


@pytest.mark.parametrize("gear", GEARS + RINGS, ids=ids)
def test_pins_of_the_measure_just_touch_both_flanks_of_their_space(gear):
    for factor in (0.99, 1.0, 1.05):
        over = gk.gear.over_pins(gear, factor * gk.gear.over_pins(gear).pin)
        centre = over.radius * np.exp(1j * (np.pi / 2 + np.pi / gear.teeth))
        _, away = gk.nearest(gear.outline.piece, np.array([centre]))
        assert away[0] == pytest.approx(over.pin / 2, abs=1e-9)
        ring = isinstance(gear, gk.RingGear)
        opposite = gear.teeth // 2
        other = centre * np.exp(2j * np.pi * opposite / gear.teeth)
        assert over.diameter == pytest.approx(abs(centre - other) + (-over.pin if ring else over.pin), rel=1e-12)


@pytest.mark.parametrize("gear", GEARS, ids=ids)
def test_a_span_is_measured_on_the_involute_or_refused_with_the_nearest_that_is(gear):
    fitting = {}
    for teeth in range(1, gear.teeth):
        try:
            fitting[teeth] = gk.gear.span(gear, teeth)
        except gk.DesignError as refused:
            assert refused.field == "teeth" and str(teeth) in refused.problem
            fitting[teeth] = refused.remedy
    good = [teeth for teeth, found in fitting.items() if not isinstance(found, str)]
    # Jaws touch as high on the flanks as half the span's tangent reaches: between form and tip circle, and nowhere else.
    reach = np.hypot(gear.base_radius, [fitting[good[0]].length / 2 + k * gear.base_pitch / 2 for k in (-1, len(good))])
    assert (good[0] == 1 or reach[0] < gear.form_radius) and reach[1] > gear.tip_radius
    for teeth, found in fitting.items():
        if teeth in good:
            assert gear.form_radius * (1 - 1e-12) <= found.radius <= gear.tip_radius * (1 + 1e-12)
        else:
            assert found == f"give {min(good, key=lambda k: abs(k - teeth))}"
    middle = sum(np.sqrt(r**2 - gear.base_radius**2) for r in (gear.form_radius, gear.tip_radius)) / 2
    chosen = gk.gear.span(gear)
    assert all(abs(chosen.length / 2 - middle) <= abs(fitting[k].length / 2 - middle) + 1e-12 for k in good)


def test_a_gear_of_which_no_teeth_can_be_spanned_is_measured_over_pins_as_the_refusal_says():
    gear = gk.SpurGear(5, 2, 0, gk.gear.RackCutter(tip_radius=0.1), addendum=0.05)
    for teeth in (None, 1, 2):
        with pytest.raises(gk.DesignError):
            gk.gear.span(gear, teeth)
    assert gear.form_radius < gk.gear.over_pins(gear).contact < gear.tip_radius
    blunt = gk.SpurGear(17, 2, -0.5, gk.gear.RackCutter(tip_radius=0.1), addendum=1.0)
    with pytest.raises(gk.DesignError):
        gk.gear.over_pins(blunt)
    assert gk.gear.span(blunt).teeth == 2


@pytest.mark.parametrize("gear", GEARS, ids=ids)
def test_a_chord_is_measured_over_the_whole_involute_and_refused_beside_it(gear):
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.chord(gear, 2 * gear.tip_radius)
    low, high = (float(word) for word in caught.value.remedy.split()[1::2])
    assert low == pytest.approx(gear.form_radius, rel=1e-5) and high == pytest.approx(gear.tip_radius, rel=1e-5)
    for radius in (low, high):
        found = gk.gear.chord(gear, radius)
        half = complex(radius * np.sin(found.half_angle), radius * np.cos(found.half_angle))
        assert gk.nearest(gear.outline.piece, np.array([half]))[1][0] < 1e-9
        assert (found.chord, found.height) == pytest.approx((2 * half.real, gear.tip_radius - half.imag))
    for radius in (low * (1 - 1e-4), high * (1 + 1e-4)):
        with pytest.raises(gk.DesignError):
            gk.gear.chord(gear, radius)


@pytest.mark.parametrize("kind", ["spur-gear", "ring-gear"])
def test_deviations_of_measures_are_those_of_a_gear_with_the_thinnest_teeth(kind):
    """Deviations in a recipe against a gear that is designed thinner by the tolerance."""
    table = {"teeth": 48, "module": 2, "tooth_thickness_allowance": 0.02}
    measuring = {"thickness_tolerance": 0.08, "pin_diameter": 3.6}
    measures = gk.load({"kind": kind, "gear": table, "measuring": measuring}).notes["measures_mm"]
    thin = gk.load({"kind": kind, "gear": table | {"tooth_thickness_allowance": 0.1}}).design
    word = "over_pins" if kind == "spur-gear" else "between_pins"
    assert measures[word]["pin_diameter"] == 3.6
    least = measures[word]["measure"] + measures[word]["tolerance"]
    assert gk.gear.over_pins(thin, 3.6).diameter == pytest.approx(least, abs=1e-6)
    assert (measures[word]["tolerance"] < 0) == (kind == "spur-gear")
    if span := measures.get("span"):
        assert gk.gear.span(thin, span["teeth"]).length == pytest.approx(span["measure"] + span["tolerance"], abs=1e-6)


@pytest.mark.parametrize("teeth", [12, 24, 60])
@pytest.mark.parametrize(("module", "step"), [(0.5, 0.05), (2, 0.25), (8, 0.5)])
def test_pins_have_usual_diameters_unless_others_are_given(teeth, module, step):
    gear = {"kind": "spur-gear", "gear": {"teeth": teeth, "module": module}}
    pin = gk.load(gear).notes["measures_mm"]["over_pins"]["pin_diameter"]
    assert pin / step == pytest.approx(round(pin / step), abs=1e-6)
    # Pins that would lie below the tips are not taken.
    small = gk.load({**gear, "measuring": {"pin_diameter": 0.1 * module}}).notes["measures_mm"]["over_pins"]
    assert small["pin_diameter"] == pin
