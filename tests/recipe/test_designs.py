"""What a recipe gives is its design where nothing is found or chosen; the kinds' classes by their names."""

import pytest

import geomkin as gk

PINS, SPAN, CHORD = "over_pins", "span", "chordal_thickness"


@pytest.mark.parametrize(
    ("gear", "told"),
    [
        ("teeth = 24", {PINS, SPAN, CHORD}),
        ("teeth = 5\naddendum = 0.05\n[gear.rack]\ntip_radius = 0.1", {PINS}),
        ("teeth = 17\nprofile_shift = -0.5\naddendum = 1\n[gear.rack]\ntip_radius = 0.1", {SPAN, CHORD}),
    ],
)
@pytest.mark.parametrize("helix", [0, 20])
def test_notes_of_a_gear_leave_out_what_cannot_be_measured(gear, told, helix):
    recipe = gk.load(
        f'kind = "spur-gear"\nhelix_angle_deg = {helix}\nstock = {{ thickness = 30 }}\n[gear]\nmodule = 2\n{gear}\n'
    )
    measures, design = recipe.notes["measures_mm"], recipe.design
    # Round pins and chords are for straight teeth.
    assert {PINS, SPAN, CHORD} & set(measures) == (told & {SPAN} if helix else told)
    for measure, name in ((gk.gear.over_pins, PINS), (gk.gear.span, SPAN)):
        if name in told:
            measure(design)
        else:
            with pytest.raises(gk.DesignError):
                measure(design)


@pytest.mark.parametrize(("slider", "made"), [(2.0, True), (0.2, True), (1e-5, False)])
def test_steps_tell_of_a_counterweight_where_one_is_cut_and_it_has_the_best_product(slider, made):
    recipe = gk.load(
        f'kind = "shaking-force"\nlinkage = {{ crank = 30, coupler = 90 }}\nmasses = {{ slider = {slider} }}\n'
        "weight_density = 2700\nstock = { thickness = 4 }\n"
    )
    weights = [part for part in recipe.parts if part.name == "counterweight"]
    assert len(weights) == made
    for part in weights:
        # Mass of the plate times the distance of its middle from the shaft, on the side away from the crank pin.
        whole, *holes = [gk.area(c) * gk.plane.centroid(c) for c in (part.outline, *part.holes)]
        product = (whole - sum(holes)) * 4 * 2700e-9
        assert product == pytest.approx(-recipe.best.product.real, rel=1e-6)
