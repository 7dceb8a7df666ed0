"""How gears go together, told in full: what rarely comes together is told as well as what mostly does."""

import re
from dataclasses import replace

import pytest

import geomkin as gk

from .test_bases import cam

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
CAM = """kind = "disk-cam"
cam.base_radius = 40
cam.follower = {kind = "translating-roller", roller_radius = 10}
cam.program = [{kind = "rise", law = "harmonic", rise = 20, end_deg = 180}, {kind = "return", law = "harmonic", end_deg = 360}]
"""

# A recipe; what its steps say, in this order; what they do not say; what is bought.
TOLD = {
    "a motor under a base without screws": (
        PAIR + MOTOR + "base = {screw = 0}\n",
        ["layer 0: lay base; fix the motor under base", "keep as much free under base as motor NEMA 17 is long, and at least 10 mm"],
        ["screw base down", "tube"],
        {"shaft 8 mm, at least 28 mm long": 1, "M3 x 10 countersunk screw ISO 7046": 4},
    ),
    "a cam on a motor under a base without screws": (
        CAM + 'stock = {bore = 5, bore_form = "D", motor = "nema17"}\nbase = {screw = 0}\n',
        ["fix the motor under base", "lay cam on A, flat on flat",
         "keep as much free under base as motor NEMA 17 is long, and at least 10 mm", "a spring or a weight of yours"],
        ["screw base down", "tube"],
        {"M3 x 8 countersunk screw ISO 7046": 4},
    ),
    "a base without screws": (
        PAIR + "first_stock = {bore = 5}\nsecond_stock = {bore = 8}\nbase = {screw = 0}\n",
        ["collar on A from below", "collar on B from below", "a collar on A", "a collar on B", "keep 10 mm free under"],
        ["tube", "screw"],
        {"shaft 5 mm, at least 28 mm long": 1, "shaft 8 mm, at least 28 mm long": 1},
    ),
    "screws of a ring that no standard has": (
        PLANETARY % (HERRINGBONE + "base = {screw = 7}\nsun_stock = {bore = 8}", 1),
        ["lay ring; 6 screws B", "lay planet between sun and ring: it turns sun", "make ring in two halves",
         "screw base down by its corners, a tube of 16 mm under each"],
        ["evenly round", "carrier", "collar on C"],
        {"screw 7 mm with nut, at least 26 mm long": 6, "tube 7 mm inside, cut to 16 mm": 4},
    ),
    "planets pressed on shafts over a base": (
        PLANETARY % ('base = {}\nsun_stock = {bore = 8}\nplanet_stock = {bore = 6, fit = "press"}', 3),
        ["press each planet on a shaft C, flush with it", "lay 3 x planet", "24 + 60 teeth divide by 3",
         "layer 2: lay carrier on A and C; 3 collars on C; a collar on A"],
        ["glue 3", "two halves", "C from below"],
        {"shaft 6 mm, at least 20 mm long": 3, "shaft collar DIN 705 A, 6 mm": 3,
         "shaft 8 mm, at least 34 mm long": 1, "M4 x 20 button head screw ISO 7380-1": 6},
    ),
    "planets pressed on shafts under which the carrier is": (
        PLANETARY % ('planet_stock = {bore = 6, fit = "press"}', 3),
        ["layer 0: lay carrier", "press each planet on a shaft, flush with it", "3 collars on the shafts of planet from below",
         "keep 10 mm free under carrier", "hold ring, and the shaft of sun in its middle: no plate here does"],
        ["glue 3", "base"],
        {"shaft 6 mm, at least 20 mm long": 3, "shaft collar DIN 705 A, 6 mm": 3},
    ),
    "one planet on a carrier": (
        PLANETARY % ("planet_stock = {bore = 6}", 1),
        ["layer 0: lay carrier; glue 1 shaft of planet into carrier, flush below", "layer 1: lay sun; lay ring round it",
         "lay planet between sun and ring: it turns sun until it goes in; 1 collar on the shaft of planet"],
        ["1 collars", "shafts", "keep"],
        {"shaft 6 mm, at least 20 mm long": 1, "shaft collar DIN 705 A, 6 mm": 1},
    ),
    "a herringbone rack": (
        RACK + HERRINGBONE + "base = {}\n",
        ["glue 2 pins B into rack", "put pinion and rack in mesh beside it, and lay them on together",
         "2 collars on B from below", "lay pinion on A"],
        ["two halves"],
        {"pin 4 mm, at least 24 mm long": 2, "shaft 6 mm, at least 32 mm long": 1, "tube 4 mm inside, cut to 10 mm": 4},
    ),
    "a lantern in a ring": (
        LANTERN % "addendum = 3, internal = true",
        ["glue 12 pins into the first disc", "lay ring round the pins, any tooth in any space",
         "glue the second disc on the pins, 6.5 mm over the first, so that ring turns", "hold the axes 72 mm apart"],
        ["mate", "between the pins"],
        {"pin 5 mm, at least 18.5 mm long": 12, "shaft 8 mm, at least 34.5 mm long": 1},
    ),
    "a lantern on a motor": (
        LANTERN % "addendum = 7.5" + 'stock = {bore = 5, bore_form = "D", motor = "nema17"}\n',
        ["layer 0: screw motor_plate from above on motor NEMA 17, its shaft up, by 4 screws",
         "layer 1: glue 12 pins into the first disc, flush below; lay it on its motor's shaft, flat on flat, 2 mm above",
         "layer 2: lay mate on its shaft", "a collar on the shaft of mate at either end",
         "layer 3: glue the second disc on the pins, its flat on that of the shaft", "hold the axes 120 mm apart"],
        ["tube", "base", "key"],
        {"M3 x 10 button head screw ISO 7380-1": 4, "shaft 8 mm, at least 22 mm long": 1},
    ),
    "a keyed lantern over a base": (
        LANTERN % "addendum = 7.5" + 'stock = {bore = 8, bore_form = "keyed"}\nbase = {}\n',
        ["a collar on A from below", "layer 1: glue 12 pins", "lay it on A with its key", "keyway 2 mm wide",
         "a tube of 6 mm on B", "layer 2: lay mate on B", "a collar on B",
         "layer 3: glue the second disc on the pins, with a key of its own", "a collar on A", "screw base down"],
        ["hold the axes"],
        {"shaft 8 mm, at least 40.5 mm long": 1, "parallel key DIN 6885-1 A 2 x 2 x 6": 2,
         "shaft 8 mm, at least 34 mm long": 1, "shaft collar DIN 705 A, 8 mm": 4, "tube 8 mm inside, cut to 6 mm": 1},
    ),
    "two gears of unequal sheets": (
        PAIR + "first_stock = {bore = 8, thickness = 5}\nsecond_stock = {bore = 10, thickness = 9}\n",
        ["layer 0: lay base; put A through from above; a collar on A from below; put B through from above; a collar on B from below\n",
         "layer 1: lay first on A, where it turns unless it is glued; lay second on B, where it turns unless it is glued, "
         "in mesh with first, any tooth in any space; a collar on A; a collar on B\n", "keep 12 mm free under base"],
        ["beside it", "both together", "screw"],
        {"shaft 8 mm, at least 26 mm long": 1, "shaft collar DIN 705 A, 8 mm": 2, "shaft 10 mm, at least 34 mm long": 1,
         "shaft collar DIN 705 A, 10 mm": 2},
    ),
    "two gears without shafts": (
        PAIR + "first_stock = {bore = 0}\nsecond_stock = {bore = 0}\n",
        ["layer 0: lay first; lay second, in mesh with first, any tooth in any space\n", "hold the axes 50 mm apart"],
        ["on A", "collar", "base"],
        {},
    ),
    "herringbones over a base": (
        PAIR + HERRINGBONE + "first_stock = {bore = 8}\nsecond_stock = {bore = 10}\nbase = {}\n",
        ["layer 1: put first and second in mesh beside it: herringbones do not slide", "; lay first on A, where it turns unless it is glued; lay second on B",
         ", both together; a collar on A", "a tube of 12 mm"],
        ["any space", "hold the axes", "layer 2"],
        {"screw 4 mm, at least 18 mm long": 4, "tube 4 mm inside, cut to 12 mm": 4},
    ),
    "a motor under two gears without a base of its own": (
        PAIR + MOTOR,
        ["layer 1: lay base on the heads of its screws; put B through from above; a collar on B from below",
         "layer 2: lay first on A, flat on flat; lay second on B", "in mesh with first", "; a collar on B\n", "keep 10 mm free under base"],
        ["collar on A", "fix the motor", "above motor_plate"],
        {"M3 x 10 button head screw ISO 7380-1": 4, "shaft 8 mm, at least 28 mm long": 1},
    ),
    "planets and their sun on a carrier": (
        PLANETARY % ("sun_stock = {bore = 8, thickness = 5}\nplanet_stock = {bore = 6, thickness = 7}", 2),
        ["layer 0: lay carrier; put the shaft of sun through from above; a collar on the shaft of sun from below; glue 2 shafts of planet into carrier, flush below",
         "layer 1: lay sun on its shaft", "; lay ring round it; lay 2 x planet", "24 + 60 teeth divide by 2",
         "; 2 collars on the shafts of planet; a collar on the shaft of sun\n", "keep 10 mm free under carrier", "hold ring, and the shaft of sun"],
        ["from below; 2 collars", "each planet"],
        {"shaft 8 mm, at least 28 mm long": 1, "shaft 6 mm, at least 22 mm long": 2, "shaft collar DIN 705 A, 6 mm": 2},
    ),
    "planets without shafts": (
        PLANETARY % ("sun_stock = {bore = 8}\nplanet_stock = {bore = 0}", 3),
        ["layer 0: lay sun on its shaft", "lay ring round it; lay 3 x planet", "a collar on the shaft of sun at either end\n", "hold ring"],
        ["carrier", "shafts", "layer 1", "flush"],
        {"shaft 8 mm, at least 22 mm long": 1},
    ),
    "planets pressed on nothing": (
        PLANETARY % ('base = {}\nsun_stock = {bore = 8}\nplanet_stock = {bore = 0}\nring_stock = {thickness = 9}', 3),
        ["layer 1: lay sun on A", "lay ring; 6 screws B", "; lay 3 x planet", "; a collar on A\n"],
        ["carrier", "collars", "layer 2", " C"],
        {"shaft 8 mm, at least 31 mm long": 1, "M4 x 30 button head screw ISO 7380-1": 6, "M4 lock nut ISO 7040": 6},
    ),
    "glued shafts of planets in a carrier over a base": (
        PLANETARY % ("base = {}\nsun_stock = {bore = 8}\nplanet_stock = {bore = 6}", 2),
        ["a collar on A from below", "layer 1: lay sun on A", "layer 2: glue 2 shafts C into carrier, 6 mm out of it below; lay carrier on A, C in the planets; a collar on A\n",
         "a tube of 10 mm under each"],
        ["collars", "planet on a shaft", "of planet"],
        {"shaft 8 mm, at least 34 mm long": 1, "shaft 6 mm, at least 12 mm long": 2},
    ),
    "a rack without a base": (
        RACK,
        ["layer 0: lay pinion on its shaft", "lay rack in mesh with pinion, any tooth in any space; a collar on the shaft of pinion at either end",
         "guide rack with its reference line 20 mm"],
        ["glue 2 pins", " A", "layer 1"],
        {"shaft 6 mm, at least 24 mm long": 1, "shaft collar DIN 705 A, 6 mm": 2},
    ),
    "a rack whose guide pins have the wider collars": (
        RACK.replace("module = 2", "module = 4") + "base = {guide_pin = 10}\n",
        ["2 collars on B from below, with room to slide", "a tube of 12 mm under each, so that nothing rubs"],
        ["a tube of 10"],
        {"shaft 6 mm, at least 32 mm long": 1, "pin 10 mm, at least 26 mm long": 2, "tube 4 mm inside, cut to 12 mm": 4},
    ),
    "straight-sided gears without a base": (
        'kind = "straight-sided-gears"\ngear = {teeth = 30, module = 2, flank_angle_deg = 20, addendum = 0.8}\n'
        "mate = {teeth = 40, addendum = 1.6}\nstock = {bore = 8, mate_bore = 6, thickness = 5}\n",
        ["layer 0: lay gear on its shaft, where it turns unless it is glued; lay mate on its shaft, where it turns unless it is glued, "
         "in mesh with gear, any tooth in any space", "a collar on the shaft of gear at either end; a collar on the shaft of mate at either end\n",
         "hold the axes 70 mm apart"],
        ["from below", "layer 1", " on A"],
        {"shaft 8 mm, at least 21 mm long": 1, "shaft 6 mm, at least 21 mm long": 1},
    ),
    "a lantern in a ring on a motor": (
        LANTERN % "addendum = 3, internal = true" + 'stock = {bore = 5, bore_form = "D", motor = "nema17"}\n',
        ["layer 1: glue 12 pins", "2 mm above motor_plate", "layer 2: lay ring round the pins, any tooth in any space\n",
         "layer 3: glue the second disc on the pins, its flat on that of the shaft, 6.5 mm over the first"],
        ["collar", "lay mate", "shaft of"],
        {"pin 5 mm, at least 18.5 mm long": 12},
    ),
    "a lantern whose mate has no shaft": (
        LANTERN % "addendum = 7.5" + "stock = {bore = 8, keyway_width = 3, keyway_depth = 1, thickness = 4, mate_bore = 0}\n",
        ["layer 0: glue 12 pins", "keyway 3 mm wide\n", "layer 1: lay mate, its teeth between the pins\n",
         "layer 2: glue the second disc on the pins, with a key of its own, 4.5 mm over the first", "a collar on the shaft of disc at either end"],
        ["shaft of mate", "tube"],
        {"shaft 8 mm, at least 28.5 mm long": 1, "key steel DIN 6880 3 x 3, cut to 4 mm": 2, "pin 5 mm, at least 12.5 mm long": 12},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_steps_and_bill_of_what_rarely_comes_together(name):
    text, said, left_out, taken = TOLD[name]
    recipe = gk.load(text)
    steps = "\n".join(recipe.steps)
    assert re.search(".*".join(map(re.escape, said)), steps, re.DOTALL), steps
    assert [words for words in left_out if words in steps] == []
    bought = {one.name: one.count for one in recipe.bought}
    assert bought.items() >= taken.items(), bought
    # Joints are told by letters where those are engraved, and else by their parts.
    lettered = any(letter for part in recipe.parts for letter in part.hole_names)
    joints = {joint for one in recipe.bought for joint in one.joints} - {"base", "disc"}
    assert all(joint in "ABC" if lettered else joint in [p.name for p in recipe.parts] for joint in joints), joints
    # Layers are told from the bottom up, each once; and what is laid is what is cut.
    layers = [int(number) for number in re.findall(r"^layer (\d+): ", steps, re.MULTILINE)]
    assert layers == sorted(set(layers)) and layers[0] == 0
    assert all(part.name in steps for part in recipe.parts if part.name not in ("disc", "spacer"))


# Of the gallery's arm with a roller: sizes of its stock, whether it stands on a base, what is said, and what is not.
CAMS = [
    ({"roller_bore": 0.0}, True, ["a tube of 5 mm on A; glue pin B into arm", "layer 2: lay roller; lay cam on A"], ["pin C", "of roller"]),
    ({"roller_bore": 0.0}, False, ["layer 0: lay arm, its pin through it", "layer 1: lay roller; lay cam", "hold the pivot 95 mm"],
     ["glue the pin", "base", "tube"]),
    ({"bore": 5.0, "bore_form": "D", "motor": "nema17"}, True,
     ["layer 0: lay base; fix the motor under base", "glue the pin C into arm, flush below; lay arm, its pin B through base",
      "lay roller on C", "lay cam on A, flat on flat, 5 mm above base", "screw base down", "a tube of the motor's length", "a spring or a weight"],
     ["tube of 5", "collar on A"]),
    ({"bore": 5.0, "bore_form": "D", "motor": "nema17"}, False,
     ["layer 0: screw motor_plate from above", "layer 1: glue the pin of roller into arm", "layer 2: lay roller on its pin",
      "lay cam on its motor's shaft, flat on flat, as it is drawn", "hold the pivot 95 mm from the shaft of cam"],
     ["above base", "collar on the shaft of cam", "tube"]),
    ({"pivot_bore": 0.0}, False, ["layer 0: glue the pin of roller into arm, flush below; lay arm\n", "at either end"],
     ["its pin through it"]),
]  # fmt: skip


@pytest.mark.parametrize(("sizes", "stands", "said", "left_out"), CAMS)
def test_steps_of_an_arm_with_a_roller(sizes, stands, said, left_out):
    whole = gk.load("recipes/rocker-cam.toml")
    recipe = replace(whole, stock=replace(whole.stock, **sizes), base=whole.base if stands else None)
    steps = "\n".join(recipe.steps)
    assert re.search(".*".join(map(re.escape, said)), steps, re.DOTALL), steps
    assert [words for words in left_out if words in steps] == []
    # What is glued in or laid on a pin is bought: a pin of that diameter.
    pins = {float(name.split()[1]) for name in (one.name for one in recipe.bought) if name.startswith("pin ")}
    stock = recipe.stock
    assert pins == {size for size in (stock.roller_bore, stock.pivot_bore) if size}


FREE = "where it turns unless it is glued"
ON_A = f"lay cam on A, {FREE}, as it is drawn and not turned over; a collar on A"
ALONE = f"lay cam on its shaft, {FREE}, as it is drawn and not turned over; a collar on the shaft of cam at either end"
BASE = "layer 0: lay base; put A through from above; a collar on A from below"
FEET = "screw base down by its corners, a tube of 12 mm under each, so that nothing rubs under it"
PINS = "lay follower, its pins through the slot B of base; 2 collars on B from below, with room to slide"
ROLLER = "where it turns freely; a collar on"
CAM_SHAFT, TEN = {"shaft 10 mm, at least 25 mm long": 1}, {"shaft collar DIN 705 A, 10 mm": 2}
GUIDE_PINS = {"pin 6 mm, at least 18 mm long": 2, "shaft collar DIN 705 A, 6 mm": 2}
ROLLER_PIN = {"shaft collar DIN 705 A, 4 mm": 1}
STANDS = {"screw 4 mm, at least 17 mm long": 4, "tube 4 mm inside, cut to 12 mm": 4}
# Follower, whether it stands on a base: all steps, and all that is bought. Sheets are 5 mm thick, collars on shafts of
# 4, 6 and 10 mm are 8, 8 and 10 mm wide, and 2 mm are free below.
WHOLE = [
    ("roller", True,
     [BASE, f"layer 1: a tube of 5 mm on A; glue 2 pins B into follower, flush above; glue the pin C into follower, flush below; {PINS}",
      f"layer 2: lay roller on C, {ROLLER} C, with room to turn; {ON_A}", FEET, "a spring or a weight of yours holds roller to cam"],
     {"shaft 10 mm, at least 35 mm long": 1, "tube 10 mm inside, cut to 5 mm": 1, "pin 4 mm, at least 18 mm long": 1}
     | TEN | GUIDE_PINS | ROLLER_PIN | STANDS),
    ("roller", False,
     [f"layer 0: lay roller on its pin, {ROLLER} its pin, with room to turn; {ALONE}", "a spring or a weight of yours holds roller to cam",
      "guide a stem with the pin of the roller, and hold the shaft of cam: no plate here does"],
     CAM_SHAFT | TEN | ROLLER_PIN | {"pin 4 mm, at least 13 mm long": 1}),
    ("knife edge", True,
     [BASE, f"layer 1: a tube of 5 mm on A; glue 2 pins B into follower, flush above; {PINS}", f"layer 2: {ON_A}", FEET,
      "a spring or a weight of yours holds follower to cam"],
     {"shaft 10 mm, at least 35 mm long": 1, "tube 10 mm inside, cut to 5 mm": 1} | TEN | GUIDE_PINS | STANDS),
    ("knife edge", False,
     [f"layer 0: {ALONE}", "a spring or a weight of yours holds the follower to cam", "guide a stem, and hold the shaft of cam: no plate here does"],
     CAM_SHAFT | TEN),
    ("flat", True,
     [BASE, f"layer 1: glue 2 pins B into follower, flush above; {PINS}; {ON_A}", FEET, "a spring or a weight of yours holds follower to cam"],
     {"shaft 10 mm, at least 30 mm long": 1} | TEN | GUIDE_PINS | STANDS),
    ("flat", False,
     [f"layer 0: lay follower, its pin through it into what is to hold it; {ALONE}", "a spring or a weight of yours holds follower to cam",
      "guide follower, and hold the shaft of cam: no plate here does"],
     CAM_SHAFT | TEN | {"pin 6 mm, at least 5 mm long": 1}),
    ("flat arm", True,
     [BASE, f"layer 1: glue pin B into arm, flush above; lay arm, its pin B through base; a collar on B from below, with room to turn; {ON_A}",
      FEET, "a spring or a weight of yours holds arm to cam"],
     {"shaft 10 mm, at least 30 mm long": 1, "pin 6 mm, at least 18 mm long": 1, "shaft collar DIN 705 A, 6 mm": 1} | TEN | STANDS),
    ("flat arm", False,
     [f"layer 0: lay arm, its pin through it into what is to hold it; {ALONE}", "a spring or a weight of yours holds arm to cam",
      "hold the pivot 80 mm from the shaft of cam: no plate here does"],
     CAM_SHAFT | TEN | {"pin 6 mm, at least 5 mm long": 1}),
]  # fmt: skip


def test_feet_are_as_high_as_the_widest_collar_under_a_base_asks_for():
    """A collar 8 mm wide on the cam's shaft, and such of 10 mm on the pins that slide below."""
    recipe = cam("flat")
    small = replace(recipe, stock=replace(recipe.stock, bore=8.0, pivot_bore=10.0, bar_width=16.0, stem_length=60.0))
    assert {one.name: one.count for one in small.bought}.items() >= {"tube 4 mm inside, cut to 12 mm": 4}.items()


@pytest.mark.parametrize(("name", "stands", "steps", "taken"), WHOLE)
def test_all_steps_and_the_whole_bill_of_cams(name, stands, steps, taken):
    recipe = cam(name, "[base]\n" if stands else "")
    assert list(recipe.steps) == steps
    assert {one.name: one.count for one in recipe.bought} == taken
    marked = replace(recipe, stock=replace(recipe.stock, timing_mark=True))
    added = "its line is under the follower at cam angle 0, and its arrow the way it turns"
    last = next(k for k, step in reversed(list(enumerate(steps))) if step.startswith("layer"))
    laid, on_top = steps[last].split("turned over; ")
    assert list(marked.steps) == [*steps[:last], f"{laid}turned over; {added}; {on_top}", *steps[last + 1 :]]
