"""Masses of parts: closed forms, polygons of the flattened outlines, and the solids that are written."""

import numpy as np
import pytest
import trimesh

import geomkin as gk
from tests.campaign import by_default

STEEL = gk.making.material("steel-S235")


def polygon_moments(curve):
    """Area, first and polar second moment of a fine polygon, by the shoelace formulas."""
    a = gk.flatten(curve, 1e-6)
    b = np.roll(a, -1)
    twice = (np.conj(a) * b).imag
    polar = twice * (np.abs(a) ** 2 + np.abs(b) ** 2 + (np.conj(a) * b).real) / 12
    return np.array([twice.sum() / 2, ((a + b) * twice).sum() / 6, polar.sum()]) * np.sign(twice.sum())


CURVES = {
    "gear": gk.SpurGear(17, 2).outline,
    "ring": gk.RingGear(60, 2, addendum=0.8).outline,
    "slot": gk.plane.slot(100 + 3j, 150 + 40j, 5.0),
    "clockwise hull": gk.plane.Reversed(gk.plane.rounded_hull([0j, 80 + 0j, 30 + 40j], 7.0)),
    "cam": gk.undercut(
        gk.Cam(
            gk.TranslatingRoller(10),
            gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360))),
            40,
        )
    ).outline,
}


@pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)
def test_moments_are_those_of_a_fine_polygon(curve):
    found = gk.plane.area_moments(curve)
    area, first, polar = polygon_moments(curve)
    assert found.area == pytest.approx(area.real, rel=1e-6)
    assert abs(found.first - first) < 1e-6 * area.real * np.sqrt(area.real)
    assert found.polar == pytest.approx(polar.real, rel=1e-6)


def test_bar_with_holes_has_the_mass_of_the_textbook():
    """A rounded bar: a rectangle and two half discs, with the parallel axis theorem, less two holes."""
    length, radius, hole, thick = 90.0, 7.0, 2.1, 3.0
    outline = gk.plane.slot(0j, complex(length), radius)
    holes = tuple(gk.plane.Circle(complex(x), hole) for x in (0, length))
    mass = gk.Part("bar", outline, holes, thick, material=STEEL).mass
    rectangle, disc, cut = 2 * radius * length, np.pi * radius**2, np.pi * hole**2
    area = rectangle + disc - 2 * cut
    # A half disc's centroid lies 4 r / 3 pi from its middle.
    out = 4 * radius / (3 * np.pi)
    half = disc / 2 * (radius**2 / 2 - out**2 + (length / 2 + out) ** 2)
    polar = rectangle * (length**2 + (2 * radius) ** 2) / 12 + 2 * half
    polar -= 2 * cut * (hole**2 / 2 + (length / 2) ** 2)
    assert mass.mass == pytest.approx(7850e-9 * thick * area, rel=1e-12)
    assert mass.centre == pytest.approx(length / 2)
    assert mass.inertia == pytest.approx(7850e-9 * thick * polar, rel=1e-12)


SOLIDS = {
    "four-bar": {
        "kind": "four-bar",
        "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [40, 25]},
        "stock": {"material": "birch-plywood"},
    },
    "helical rack and pinion": {
        "kind": "rack-and-pinion",
        "pinion": {"teeth": 20, "module": 2},
        "rack": {"teeth": 6, "module": 2},
        "helix_angle_deg": 20,
        "stock": {"material": "POM", "thickness": 12, "bore": 8},
        "files": {"tolerance": 0.001},
    },
}


@pytest.mark.parametrize("data", by_default(SOLIDS.values(), [SOLIDS["four-bar"]]), ids=SOLIDS)
def test_masses_are_those_of_the_written_solids(data, tmp_path):
    recipe = gk.load(data)
    files = gk.make(recipe, tmp_path, ["stl"]).files
    solids = {path.stem: trimesh.load(path) for path in files if path.suffix == ".stl"}
    for part in recipe.parts:
        solid = solids[part.name]
        density = part.material.density * 1e-9
        assert part.mass.mass == pytest.approx(density * solid.volume, rel=2e-3)
        assert abs(part.mass.centre - complex(*solid.center_mass[:2])) < 0.02
        assert part.mass.inertia == pytest.approx(density * solid.moment_inertia[2, 2], rel=3e-3)


def test_threaded_rods_weigh_what_makers_state():
    """kg per m of DIN 976-1 rods, from makers' lists, rounded to g."""
    from geomkin.making.fasteners import Fastener

    for diameter, listed in ((4.0, 0.078), (5.0, 0.124), (6.0, 0.177), (8.0, 0.319)):
        rod = Fastener(diameter, "screw", 0.0)
        per_mm = rod.volume(501.0) - rod.volume(500.0)
        assert 7.85e-6 * per_mm * 1000 == pytest.approx(listed, rel=0.02)


def test_bodies_carry_their_screws():
    data = SOLIDS["four-bar"]
    screws = gk.masses(gk.load(data))
    rods = gk.masses(gk.load({**data, "stock": {**data["stock"], "fastener": "rod"}}))
    assert set(screws) == {"ground", "crank", "coupler", "rocker"}
    assert sum(m.mass for m in screws.values()) > sum(m.mass for m in rods.values())
    plates = sum(part.mass.mass for part in gk.load(data).parts if part.body)
    assert 1.2 * plates < sum(m.mass for m in screws.values()) < 3 * plates


def test_material_may_be_a_table_of_values_and_is_written_back_by_name():
    from geomkin.recipe.load import to_toml

    data = SOLIDS["four-bar"]
    oak = gk.load({**data, "stock": {"material": {"name": "oak", "density": 700, "strength": 60}}})
    assert oak.parts[0].material == gk.Material("oak", 700, strength=60)
    assert gk.load(to_toml(oak)) == oak
    assert 'material = "birch-plywood"' in to_toml(gk.load(data))


def test_masses_without_a_material_name_the_key():
    with pytest.raises(gk.DesignError) as error:
        gk.masses(gk.load({**SOLIDS["four-bar"], "stock": {}}))
    assert error.value.field == "stock.material"


def test_unknown_material_is_refused_at_its_key():
    with pytest.raises(gk.RecipeError, match=r"stock\.material: found 'unobtanium'"):
        gk.load({**SOLIDS["four-bar"], "stock": {"material": "unobtanium"}})
