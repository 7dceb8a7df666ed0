"""Linkages of every make, for tests that hold for all of them."""

import numpy as np

import geomkin as gk
from geomkin.linkage.instant.curvature import crank_path
from tests.made import Made

FOUR_BAR = gk.FourBar(100, 30, 90, 70, 40 + 25j)
TURN = np.linspace(0, 2 * np.pi, 73)


def walking_leg():
    """Jansen's leg as bodies that share the names of their pins."""
    return gk.Linkage(
        {
            "ground": {"O": 0, "F": -38 - 7.8j},
            "crank": {"O": 0, "M": 15},
            "upper": {"M": 0, "B": 50},
            "triangle": {"F": 0, "B": 41.5, "D": 1.3 + 40.1j},
            "lower": {"M": 0, "E": 61.9},
            "link": {"F": 0, "E": 39.3},
            "parallel": {"D": 0, "G": 39.4},
            "leg": {"E": 0, "G": 36.7, "foot": -4 + 49j},
        },
        driver="crank",
    )


def crank_paths(motion):
    """The circles on which both pins of a four-bar's coupler run."""
    return tuple(
        crank_path(motion.point(pin).position, motion.point(pivot).position)
        for pin, pivot in (("crank_pin", "crank_pivot"), ("rocker_pin", "rocker_pivot"))
    )


def bar_that_turns_back():
    """A six-bar whose bar turns back, and the crank angle at which it does: a dead centre of the rocker."""
    bodies = {name: dict(points) for name, points in gk.FourBar(100, 30, 90, 70).linkage.bodies.items()}
    bodies["ground"]["output_pivot"] = 60 - 80j
    bodies["rocker"]["output_start"] = 40 + 25j
    bodies |= {"bar": {"output_start": 0j, "output_pin": 110 + 0j}}
    bodies |= {"output": {"output_pivot": 0j, "output_pin": 90 + 0j}}
    return gk.Linkage(bodies, driver="crank"), np.arccos((120**2 + 100**2 - 70**2) / (2 * 120 * 100))


def locked():
    """A six-bar driven by its last link: no dyad to begin with, so its loops go to iteration."""
    bodies = {
        "ground": {"O": 0, "C": 100, "E": 60 + 120j},
        "crank": {"O": 0, "A": 30},
        "coupler": {"A": 0, "B": 90, "P": 40 + 25j},
        "rocker": {"C": 0, "B": 70},
        "rod": {"P": 0, "D": 80},
        "out": {"E": 0, "D": 60},
    }
    free = gk.move(gk.Linkage(bodies, "crank"), [0.6])
    estimate = {pin: free.point(pin).position[0] + 0.5 for pin in "ABPD"}
    start = float(np.angle(free.bodies["out"].direction[0]))
    return gk.Linkage(bodies, "out", estimate=estimate), np.linspace(start, start + 0.15, 20)


def boom(order=("boom", "cylinder", "rod"), turned=False, **more):
    """A boom lifted by a cylinder on the ground; nothing lies on the slide line. The stroke is the slider's."""
    bodies = {
        "boom": {"O": 0, "B": 120 + 10j, "tip": 300},
        "cylinder": {"C": 0},
        "rod": {"B": -5 + 0j},
    }
    slide = gk.Slider("lift", "rod", "cylinder", 3 + 2j, 10 + 7j, 20, 35)
    if turned:  # the same joint as the other body has it
        slide = gk.Slider("lift", "cylinder", "rod", 10 + 7j, 3 + 2j, 145, 160)
    return gk.Linkage(
        {"ground": {"O": 0, "C": 60 - 80j}, **{name: bodies[name] for name in order}}, "lift", (slide,), **more
    )


def pushed():
    """A cylinder that pushes a crosshead, whose rod turns a crank."""
    return gk.Linkage(
        {
            "ground": {"C": 10 + 60j, "O": 20 - 50j},
            "cylinder": {"C": 4 + 0j},
            "rod": {"A": -5 + 1j},
            "head": {"A": 2 + 3j, "D": -1j},
            "link": {"D": 0, "E": 80},
            "crank": {"E": 40 + 2j, "O": 0},
        },
        "push",
        (gk.Slider("rail", "head", "ground", 1j, 5 - 10j, 10, 15), gk.Slider("push", "rod", "cylinder", 0, 30 + 5j)),
    )


def two_parallelograms():
    """Bodies: one behind another, the bar R Q parallel to A B, and E Q turning as the crank does."""
    arm = 15 + 5j
    return {
        "ground": {"O": 0, "C": 30, "E": 60},
        "crank": {"O": 0, "A": 20},
        "coupler": {"A": 0, "B": 30},
        "rocker": {"C": 0, "B": 20, "R": arm},
        "bar": {"R": 0, "Q": 30},
        "last": {"E": 0, "Q": arm},
    }


def lift_table():
    """Two crossed arms under a table; the cylinder stands on the ground and pushes one of them."""
    return gk.Linkage(
        {
            "ground": {"O": 0, "C": 40 - 60j},
            "arm": {"O": 0, "M": 100, "B": 130 + 5j, "S": 200},
            "cross": {"F": 0, "M": 100, "P": 200},
            "table": {"P": 0, "top": 200 + 10j},
            "foot": {"F": 0},
            "shoe": {"S": 0},
            "cylinder": {"C": 0},
            "rod": {"B": 0},
        },
        "lift",
        (
            gk.Slider("floor", "foot", "ground"),
            gk.Slider("ceiling", "shoe", "table"),
            gk.Slider("lift", "rod", "cylinder"),
        ),
    )


def crossed_slots():
    """Two blocks on one pin, in a slot of the crank and one of the rocker: the slots turn at rates of their own."""
    return gk.Linkage(
        {
            "ground": {"O": 0, "C": 100},
            "crank": {"O": 0, "A": 30},
            "coupler": {"A": 0, "B": 90},
            "rocker": {"C": 0, "B": 70},
            "first": {"P": 3 + 4j, "tip": 10},
            "second": {"P": -5 + 2j},
        },
        "crank",
        (
            gk.Slider("one", "first", "crank", 1j, 5 - 2j, 20, 35),
            gk.Slider("two", "second", "rocker", 2, 8 + 1j, -30, 15),
        ),
    )


TABLE = (
    gk.Slider("along", "carriage", "ground", 1j, 4, 5, 30),
    gk.Slider("across", "table", "carriage", 2 - 1j, 7, 75, 10),
)


def on_cross_slides(ends):
    """A crank and a table that never turns, on slides along and across; `ends` lead from the one to the other."""
    start = {
        "ground": {"O": 0, "C": 150 + 20j},
        "crank": {"O": 0, "A": 30},
        "table": {"K": 5 + 8j, "L": 45 - 10j},
        "carriage": {},
    }
    more = {
        "bars": ({"bar": {"A": 0, "K": 130}, "rocker": {"C": 3j, "L": 95}}, ()),
        "bars, the rocker first": ({"rocker": {"C": 3j, "L": 95}, "bar": {"A": 0, "K": 130}}, ()),
        "bar and slide": (
            {"bar": {"A": 0, "K": 120}, "sled": {"L": 4 + 1j}},
            (gk.Slider("rail", "sled", "ground", 1, -20j, 12, 20),),
        ),
        "slide and bar": (
            {"sled": {"L": 4 + 1j}, "bar": {"A": 0, "K": 90}},
            (gk.Slider("rail", "ground", "sled", 15j, 2, 12, 20),),
        ),
        "slides": (
            {"block": {"K": 4 + 1j}, "sled": {"L": -3}},
            (gk.Slider("slot", "block", "crank", 1, 6j, 12, 20), gk.Slider("rail", "sled", "ground", 0, 70j, 8, 25)),
        ),
    }
    bodies, sliders = more[ends]
    return gk.Linkage(start | bodies, "crank", (*sliders, *TABLE))


def block_with_a_bar():
    """The block on a crank's pin that a yoke keeps from turning; a bar on it drives a rocker."""
    return gk.Linkage(
        {
            "ground": {"O": 0, "C": 150},
            "crank": {"O": 0, "A": 30},
            "block": {"A": 2 - 3j, "K": 20 + 10j},
            "yoke": {},
            "bar": {"K": 0, "B": 140},
            "rocker": {"C": 0, "B": 90},
        },
        "crank",
        (gk.Slider("way", "yoke", "ground", 1j, 2, 15, 40), gk.Slider("slot", "block", "yoke", 0, 3, 70, 25)),
    )


def coupled():
    """The driven shaft of an Oldham coupling as the crank of a four-bar."""
    return gk.Linkage(
        {
            "ground": {"D": 0, "E": 6, "C": 120},
            "driving": {"D": 0},
            "disc": {},
            "driven": {"E": 2 + 1j, "K": 40},
            "bar": {"K": 0, "B": 110},
            "rocker": {"C": 0, "B": 75},
        },
        "driving",
        (gk.Slider("first", "disc", "driving", 1, 2j), gk.Slider("second", "disc", "driven", 2j, 1, 90, -65)),
    )


def between():
    """A four-bar whose crank and rocker are pushed apart by a cylinder between them: no dyad to begin with."""
    bodies = {
        "ground": {"O": 0, "D": 100},
        "crank": {"O": 0, "A": 40, "K": 25 - 10j},
        "coupler": {"A": 0, "B": 90, "pen": 40 + 25j},
        "rocker": {"D": 0, "B": 70, "L": 50 + 8j},
    }
    by_crank = gk.Linkage(bodies, "crank")
    angle = np.linspace(1.6, 0.9, 30)
    motion = gk.move(by_crank, angle)
    # The cylinder's offset is 3 mm: its square is taken off that of the pins' distance.
    apart = np.abs(motion.point("K").position - motion.point("L").position)
    stroke = np.sqrt(apart**2 - 3**2) - 20
    estimate = {pin: motion.point(pin).position[0] + 1 for pin in "ABKL"}
    linkage = gk.Linkage(
        {**bodies, "cylinder": {"K": 0}, "rod": {"L": 0}},
        "push",
        (gk.Slider("push", "rod", "cylinder", 0, 20 + 3j),),
        estimate=estimate,
    )
    return linkage, stroke, by_crank, angle


# name: (linkage, drives, branch)
ALL = Made(
    {
        "four-bar": lambda: (FOUR_BAR, TURN, 1),
        "four-bar by rocker": lambda: (
            gk.FourBar(100, 30, 90, 70, 40 + 25j, driver="rocker"),
            np.linspace(1.7, 2.4, 30),
            -1,
        ),
        "four-bar by coupler": lambda: (gk.FourBar(100, 90, 25, 90, 12 + 40j, driver="coupler"), TURN, 1),
        "deltoid": lambda: (gk.FourBar(40, 40, 70, 70, 20 + 30j), np.linspace(0.2, 6.0, 60), 1),
        "four-bar placed elsewhere": lambda: (
            gk.FourBar(100, 30, 90, 70, 40, origin=5 - 3j, ground_angle_deg=37),
            TURN,
            -1,
        ),
        "slider-crank": lambda: (gk.SliderCrank(30, 90, 12, 40 + 5j), TURN, 1),
        "slider-crank the other way": lambda: (gk.SliderCrank(30, 90, -12, ground_angle_deg=200), TURN, -1),
        "slider-crank by coupler": lambda: (
            gk.SliderCrank(30, 90, 12, driver="coupler"),
            np.linspace(-0.2, 0.3, 30),
            1,
        ),
        "slider-crank by slider": lambda: (gk.SliderCrank(30, 90, 12, driver="slider"), np.linspace(70, 110, 30), -1),
        "slotted lever": lambda: (gk.InvertedSliderCrank(80, 30, 7, point=130), TURN, 1),
        "slotted lever by lever": lambda: (
            gk.InvertedSliderCrank(80, 30, driver="rocker"),
            np.linspace(2.9, 3.3, 30),
            -1,
        ),
        "whitworth": lambda: (gk.InvertedSliderCrank(20, 60, 3), TURN, 1),
        "sliding coupler": lambda: (gk.InvertedSliderCrank(80, 30, 5, "coupler", 130), TURN, 1),
        "stephenson": lambda: (gk.StephensonSixBar(FOUR_BAR, 80, 60, 60 + 120j), TURN, {"output_pin": -1}),
        "watt": lambda: (gk.WattSixBar(FOUR_BAR, 50 - 30j, 90, 60, 180), TURN, 1),
        "shaper": lambda: (gk.Shaper(90, 30, 180, 60, 85, origin=3j), TURN, 1),
        "trammel": lambda: (gk.EllipticTrammel(60, 100, 80), TURN, 1),
        "trammel by shuttle": lambda: (gk.EllipticTrammel(60, 100, driver="shuttle"), np.linspace(-50, 50, 30), 1),
        "scotch yoke": lambda: (gk.ScotchYoke(30, 100, 70), TURN, 1),
        "oldham": lambda: (gk.OldhamCoupling(6), TURN, 1),
        "walking leg": lambda: (walking_leg(), TURN, {"B": -1, "G": -1}),
        "crossed slots": lambda: (crossed_slots(), np.linspace(1.5, 4.0, 30), 1),
        "block with a bar": lambda: (block_with_a_bar(), TURN, 1),
        "coupled": lambda: (coupled(), TURN, 1),
        "table between bars": lambda: (on_cross_slides("bars"), TURN, -1),
        "table between bars, the rocker first": lambda: (on_cross_slides("bars, the rocker first"), TURN, 1),
        "table between bar and slide": lambda: (on_cross_slides("bar and slide"), TURN, 1),
        "table between slide and bar": lambda: (on_cross_slides("slide and bar"), TURN, -1),
        "table between slides": lambda: (on_cross_slides("slides"), np.linspace(1, 2, 30), 1),
        "loops": lambda: (*locked(), 1),
        "boom": lambda: (boom(), np.linspace(40, 150, 30), -1),
        "boom after its cylinder": lambda: (
            boom(("rod", "cylinder", "boom"), origin=5 - 3j, ground_angle_deg=37),
            np.linspace(40, 150, 30),
            1,
        ),
        "boom, the cylinder slides": lambda: (boom(turned=True), np.linspace(40, 150, 30), -1),
        "boom, pulled through": lambda: (boom(), np.linspace(-200, -60, 30), 1),
        "pushed crosshead": lambda: (pushed(), np.linspace(50, 95, 30), 1),
        "lift table": lambda: (lift_table(), np.linspace(100, 180, 30), 1),
        "actuator between moving bars": lambda: (*between()[:2], 1),
    }
)

# One example of each joint, driver and class of solution.
FEW = [
    "four-bar", "deltoid", "four-bar by coupler", "slider-crank the other way", "slider-crank by slider", "whitworth", "stephenson",
    "shaper", "trammel by shuttle", "oldham", "walking leg", "crossed slots", "block with a bar", "table between bar and slide",
    "loops", "boom after its cylinder", "boom, the cylinder slides", "pushed crosshead", "actuator between moving bars",
]  # fmt: skip
