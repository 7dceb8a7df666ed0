"""Mechanisms of every make, as general linkages, with the branches they run on."""

import numpy as np

import geomkin as gk

TURN = np.linspace(0, 2 * np.pi, 361)
CRANK = {"crank_pivot": 0j, "crank_pin": 30 + 0j}


def triangle(base, left, right):
    """Third corner over a base along x from the origin, by the lengths to its two ends."""
    x = (base**2 + left**2 - right**2) / (2 * base)
    return complex(x, (left**2 - x**2) ** 0.5)


def slotted_lever(ground, crank, end):
    return gk.Linkage(
        bodies={
            "ground": {"crank_pivot": 0j, "lever_pivot": -ground + 0j},
            "crank": {"crank_pivot": 0j, "crank_pin": crank + 0j},
            "block": {"crank_pin": 0j},
            "lever": {"lever_pivot": 0j, "lever_end": end + 0j},
        },
        driver="crank",
        sliders=(gk.Slider("slide", "block", "lever"),),
    )


def sliding_coupler(body, along):
    return gk.Linkage(
        bodies={
            "ground": {"crank_pivot": 0j, "block_pivot": 80 + 0j},
            "crank": CRANK,
            "coupler": {"crank_pin": 0j, "tip": 140 + 0j},
            "block": {"block_pivot": 0j},
        },
        driver="crank",
        sliders=(gk.Slider("slide", body, along),),
    )


def scotch_yoke(**points):
    return gk.Linkage(
        bodies={"ground": {"crank_pivot": 0j}, "crank": CRANK, "block": {"crank_pin": 0j}, "yoke": points},
        driver="crank",
        sliders=(gk.Slider("cross", "block", "yoke", direction_deg=90), gk.Slider("slide", "yoke", "ground")),
    )


TRAMMEL = gk.Linkage(
    bodies={
        "ground": {},
        "bar": {"a": 0j, "b": 60 + 0j, "pen": 100 + 0j},
        "shuttle_a": {"a": 0j},
        "shuttle_b": {"b": 0j},
    },
    driver="bar",
    sliders=(gk.Slider("x", "shuttle_a", "ground"), gk.Slider("y", "shuttle_b", "ground", direction_deg=90)),
)
OLDHAM = gk.Linkage(
    bodies={
        "ground": {"driving_pivot": 0j, "driven_pivot": 6 + 0j},
        "driving": {"driving_pivot": 0j},
        "disc": {},
        "driven": {"driven_pivot": 0j},
    },
    driver="driving",
    sliders=(
        gk.Slider("first", "disc", "driving"),
        gk.Slider("second", "disc", "driven", direction_deg=90, angle_deg=-90),
    ),
)
RAM_WITH_TOOL = gk.Linkage(
    bodies={
        "ground": {"crank_pivot": 0j},
        "crank": CRANK,
        "rod": {"crank_pin": 0j, "ram_pin": 90 + 0j},
        "ram": {"ram_pin": 0j, "tool": 40 + 15j},
    },
    driver="crank",
    sliders=(gk.Slider("slide", "ram", "ground"),),
)
RAM_BESIDE_ITS_LINE = gk.Linkage(
    bodies=RAM_WITH_TOOL.bodies,
    driver="crank",
    sliders=(gk.Slider("slide", "ram", "ground", point=-25j, through=-25j),),
)
SIX_BAR = gk.Linkage(
    bodies={
        "ground": {"crank_pivot": 0j, "rocker_pivot": 100 + 0j, "output_pivot": 140 - 20j},
        "crank": CRANK,
        "coupler": {"crank_pin": 0j, "rocker_pin": 90 + 0j, "p": 40 + 25j},
        "rocker": {"rocker_pivot": 0j, "rocker_pin": 70 + 0j},
        "rod": {"p": 0j, "q": 90 + 0j},
        "output": {"output_pivot": 0j, "q": 80 + 0j},
    },
    driver="crank",
)
# Theo Jansen's thirteen lengths.
JANSEN_LEG = gk.Linkage(
    bodies={
        "ground": {"crank_pivot": 0j, "pivot": -38 - 7.8j},
        "crank": {"crank_pivot": 0j, "crank_pin": 15 + 0j},
        "upper": {"crank_pin": 0j, "c": 50 + 0j},
        "lower": {"crank_pin": 0j, "d": 61.9 + 0j},
        "triangle": {"pivot": 0j, "c": 41.5 + 0j, "e": triangle(41.5, 40.1, 55.8)},
        "link": {"pivot": 0j, "d": 39.3 + 0j},
        "side": {"e": 0j, "f": 39.4 + 0j},
        "foot": {"d": 0j, "f": 36.7 + 0j, "toe": triangle(36.7, 49.0, 65.7)},
    },
    driver="crank",
)
# A Whitworth lever whose rod starts opposite the crank pin, and runs over all three shafts.
CROWDED = gk.Linkage(
    bodies={
        "ground": {"crank_pivot": 0j, "lever_pivot": -30j},
        "crank": {"crank_pivot": 0j, "crank_pin": 80 + 0j},
        "block": {"crank_pin": 0j},
        "lever": {"lever_pivot": 0j, "lever_end": -60 + 0j},
        "rod": {"lever_end": 0j, "ram_pin": 200 + 0j},
        "ram": {"ram_pin": 0j},
    },
    driver="crank",
    sliders=(gk.Slider("slide", "block", "lever"), gk.Slider("ram_slide", "ram", "ground", through=-30j)),
)

# name: linkage, branch, layers, whether a bridge is needed
BUILDABLE = {
    "crank-rocker": (gk.FourBar(100, 30, 90, 70, 40 + 25j), 1, 3, False),
    "drag link": (gk.FourBar(30, 100, 90, 70), 1, 5, True),
    # Its crank's pin comes within 2 mm of the rocker's pivot.
    "kite": (gk.FourBar(100, 98, 110, 110), 1, 5, True),
    "parallelogram": (gk.FourBar(100, 40, 100, 40), "follow", 3, False),
    "slider-crank": (gk.SliderCrank(30, 90), 1, 3, False),
    "offset slider-crank": (gk.SliderCrank(30, 90, offset=15, coupler_point=40 + 20j), 1, 3, False),
    "ram with a tool": (RAM_WITH_TOOL, 1, 3, False),
    "ram beside its line": (RAM_BESIDE_ITS_LINE, 1, 3, False),
    "six-bar": (SIX_BAR, 1, 4, False),
    "slotted lever": (slotted_lever(80, 30, 160), -1, 3, False),
    "whitworth": (slotted_lever(30, 80, -60), -1, 4, True),
    "sliding coupler": (sliding_coupler("coupler", "block"), 1, 3, False),
    "scotch yoke": (scotch_yoke(), 1, 3, False),
    "trammel": (TRAMMEL, 1, 3, True),
    "oldham coupling": (OLDHAM, 1, 5, True),
    "jansen leg": (JANSEN_LEG, {"c": -1, "d": 1, "f": -1}, 6, False),
}
