"""What a recipe gives is its design where nothing is found or chosen; the kinds' classes by their names."""

from importlib import import_module

import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS, recipe_class
from tests.texts import recipe_of

LINKAGES = [
    "four-bar-atlas", "slider-crank-atlas", "cognates", "inflection-circle", "centrodes", "polygons", "shaking-force",
]  # fmt: skip


@pytest.mark.parametrize(("kind", "key"), [*((kind, "linkage") for kind in LINKAGES), ("ring-gear", "gear")])
def test_the_linkage_or_gear_that_a_recipe_gives_is_its_design(kind, key):
    recipe = recipe_of(kind)
    assert recipe.design is getattr(recipe, key)


@pytest.mark.parametrize("kind", KINDS)
def test_each_row_of_the_table_names_the_classes_of_recipe_and_design(kind):
    assert recipe_class(kind).kind == kind
    module, _, name = KINDS[kind].design.partition(":")
    expected = getattr(import_module(module), name) if name else gk.recipe.AbstractRecipe
    assert isinstance(recipe_of(kind).design, expected)


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


@pytest.mark.parametrize(("first", "second"), [(0, 0), (8, 0), (0, 8), (8, 6)])
def test_steps_tell_of_a_plate_under_two_gears_where_there_is_one(first, second):
    """Both shafts need a hole in it; without it each has what holds it by itself."""
    recipe = gk.load(
        'kind = "gear-pair"\nfirst = { teeth = 12, module = 3, profile_shift = 0.3 }\n'
        f"second = {{ teeth = 24, module = 3 }}\nfirst_stock.bore = {first}\nsecond_stock.bore = {second}\n"
    )
    holds = [part.name for part in recipe.parts] == ["first", "second", "base"]
    steps = "; ".join(recipe.steps)
    assert holds == bool(first and second) == ("lay base" in steps) != ("hold the axes 54.8519 mm apart" in steps)
    shafts = {thing.name for thing in recipe.bought if thing.name.startswith("shaft ") and "collar" not in thing.name}
    assert len(shafts) == len({first, second} - {0})
    # Through gear, plate and a collar at either end, or without the plate.
    assert all(("28 mm long" if holds else "22 mm long") in name for name in shafts if name.startswith("shaft 8"))


@pytest.mark.parametrize(("slider", "made"), [(2.0, True), (0.2, True), (1e-5, False)])
def test_steps_tell_of_a_counterweight_where_one_is_cut_and_it_has_the_best_product(slider, made):
    recipe = gk.load(
        f'kind = "shaking-force"\nlinkage = {{ crank = 30, coupler = 90 }}\nmasses = {{ slider = {slider} }}\n'
        "weight_density = 2700\nstock = { thickness = 4 }\n"
    )
    weights = [part for part in recipe.parts if part.name == "counterweight"]
    assert len(weights) == made == sum("counterweight" in step for step in recipe.steps)
    for part in weights:
        # Mass of the plate times the distance of its middle from the shaft, on the side away from the crank pin.
        whole, *holes = [gk.area(c) * gk.plane.centroid(c) for c in (part.outline, *part.holes)]
        product = (whole - sum(holes)) * 4 * 2700e-9
        assert product == pytest.approx(-recipe.best.product.real, rel=1e-6)
