"""How mechanisms go together: layers from the bottom up, every part in a step, and what is bought."""

import re

import pytest

import geomkin as gk

PAIR = 'kind = "gear-pair"\nfirst = {teeth = 20, module = 2}\nsecond = {teeth = 30, module = 2}\n'
MOTOR = 'first_stock = {bore = 5, bore_form = "D", motor = "nema17"}\nsecond_stock = {bore = 8}\n'
PLANETARY = """kind = "planetary"
%s
[gears]
planets = %d
sun = {teeth = 24, module = 2}
planet = {teeth = 18, module = 2}
ring = {teeth = 60, module = 2, addendum = 0.8}
"""
HERRINGBONE = "helix_angle_deg = 20\nherringbone = true\n"
RACK = 'kind = "rack-and-pinion"\npinion = {teeth = 20, module = 2}\nrack = {teeth = 16, module = 2}\nstock = {thickness = 8, bore = 6}\n'
LANTERN = 'kind = "lantern-gears"\npinion = {pins = 12, module = 4, pin_diameter = 5}\nmate = {teeth = 48, %s}\n'

# A recipe, and some of what is bought for it.
RECIPES = {
    "a motor under a base without screws": (
        PAIR + MOTOR + "base = {screw = 0}\n",
        {"shaft 8 mm, at least 28 mm long": 1, "M3 x 10 countersunk screw ISO 7046": 4},
    ),
    "screws of a ring that no standard has": (
        PLANETARY % (HERRINGBONE + "base = {screw = 7}\nsun_stock = {bore = 8}", 1),
        {"screw 7 mm with nut, at least 26 mm long": 6, "tube 7 mm inside, cut to 16 mm": 4},
    ),
    "planets pressed on shafts over a base": (
        PLANETARY % ('base = {}\nsun_stock = {bore = 8}\nplanet_stock = {bore = 6, fit = "press"}', 3),
        {
            "shaft 6 mm, at least 20 mm long": 3,
            "shaft collar DIN 705 A, 6 mm": 3,
            "shaft 8 mm, at least 34 mm long": 1,
            "M4 x 20 button head screw ISO 7380-1": 6,
        },
    ),
    "planets pressed on shafts under which the carrier is": (
        PLANETARY % ('planet_stock = {bore = 6, fit = "press"}', 3),
        {"shaft 6 mm, at least 20 mm long": 3, "shaft collar DIN 705 A, 6 mm": 3},
    ),
    "a herringbone rack": (
        RACK + HERRINGBONE + "base = {}\n",
        {"pin 4 mm, at least 24 mm long": 2, "shaft 6 mm, at least 32 mm long": 1, "tube 4 mm inside, cut to 10 mm": 4},
    ),
    "a lantern in a ring": (
        LANTERN % "addendum = 3, internal = true",
        {"pin 5 mm, at least 18.5 mm long": 12, "shaft 8 mm, at least 34.5 mm long": 1},
    ),
    "a lantern on a motor": (
        LANTERN % "addendum = 7.5" + 'stock = {bore = 5, bore_form = "D", motor = "nema17"}\n',
        {"M3 x 10 button head screw ISO 7380-1": 4, "shaft 8 mm, at least 22 mm long": 1},
    ),
    "a keyed lantern over a base": (
        LANTERN % "addendum = 7.5" + 'stock = {bore = 8, bore_form = "keyed"}\nbase = {}\n',
        {
            "shaft 8 mm, at least 40.5 mm long": 1,
            "parallel key DIN 6885-1 A 2 x 2 x 6": 2,
            "shaft 8 mm, at least 34 mm long": 1,
            "shaft collar DIN 705 A, 8 mm": 4,
            "tube 8 mm inside, cut to 6 mm": 1,
        },
    ),
    "two gears of unequal sheets": (
        PAIR + "first_stock = {bore = 8, thickness = 5}\nsecond_stock = {bore = 10, thickness = 9}\n",
        {
            "shaft 8 mm, at least 26 mm long": 1,
            "shaft collar DIN 705 A, 8 mm": 2,
            "shaft 10 mm, at least 34 mm long": 1,
            "shaft collar DIN 705 A, 10 mm": 2,
        },
    ),
    "two gears without shafts": (PAIR + "first_stock = {bore = 0}\nsecond_stock = {bore = 0}\n", {}),
    "a motor under two gears without a base of its own": (
        PAIR + MOTOR,
        {"M3 x 10 button head screw ISO 7380-1": 4, "shaft 8 mm, at least 28 mm long": 1},
    ),
    "planets and their sun on a carrier": (
        PLANETARY % ("sun_stock = {bore = 8, thickness = 5}\nplanet_stock = {bore = 6, thickness = 7}", 2),
        {"shaft 8 mm, at least 28 mm long": 1, "shaft 6 mm, at least 22 mm long": 2, "shaft collar DIN 705 A, 6 mm": 2},
    ),
    "a rack without a base": (RACK, {"shaft 6 mm, at least 24 mm long": 1, "shaft collar DIN 705 A, 6 mm": 2}),
    "a lantern whose mate has no shaft": (
        LANTERN % "addendum = 7.5"
        + "stock = {bore = 8, keyway_width = 3, keyway_depth = 1, thickness = 4, mate_bore = 0}\n",
        {
            "shaft 8 mm, at least 28.5 mm long": 1,
            "key steel DIN 6880 3 x 3, cut to 4 mm": 2,
            "pin 5 mm, at least 12.5 mm long": 12,
        },
    ),
}


def layers_of(steps):
    return [int(number) for number in re.findall(r"^layer (\d+): ", "\n".join(steps), re.MULTILINE)]


@pytest.mark.parametrize("name", RECIPES)
def test_steps_go_upwards_with_every_part_and_the_bill_has_the_rest(name):
    text, taken = RECIPES[name]
    recipe = gk.load(text)
    steps = "\n".join(recipe.steps)
    bought = {one.name: one.count for one in recipe.bought}
    assert bought.items() >= taken.items(), bought
    # Joints have letters where those are engraved, and else the names of their parts.
    lettered = any(letter for part in recipe.parts for letter in part.hole_names)
    joints = {joint for one in recipe.bought for joint in one.joints} - {"base", "disc"}
    assert all(joint in "ABC" if lettered else joint in [p.name for p in recipe.parts] for joint in joints), joints
    layers = layers_of(recipe.steps)
    assert layers == sorted(set(layers)) and layers[0] == 1
    assert all(part.name in steps for part in recipe.parts if part.name not in ("disc", "spacer"))


@pytest.mark.parametrize("base", ["", "base = {}\n"])
@pytest.mark.parametrize("follower", ["translating-roller", "oscillating-roller"])
@pytest.mark.parametrize("fit", ["running", "H7/k6", "press"])
def test_glue_is_bought_where_a_step_glues_a_pin(fit, follower, base):
    swings = follower.startswith("oscillating")
    sizes, rise = (", arm_length = 60, pivot_distance = 70", "rise_deg = 15") if swings else ("", "rise = 10")
    recipe = gk.load(
        f'kind = "disk-cam"\n{base}stock = {{bore = 12, fit = "{fit}"}}\n[cam]\nbase_radius = 30\n'
        f'follower = {{kind = "{follower}", roller_radius = 8{sizes}}}\n[[cam.program]]\nkind = "rise"\nlaw = "cycloidal"\n'
        f'{rise}\nend_deg = 180\n[[cam.program]]\nkind = "return"\nlaw = "cycloidal"\nend_deg = 360\n'
    )
    pins = sum(int(count or 1) for step in recipe.steps for count in re.findall(r"glue (?:the |(\d) )?pin", step))
    assert sum(item.count for item in recipe.bought if "glue" in item.name) == pins
    assert pins == (2 if swings and base else 1 if swings else 3 if base else 0)
