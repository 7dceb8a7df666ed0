"""STEP files of the whole gallery as a CAD kernel reads them. Needs the extra `kernel`."""

from pathlib import Path

import pytest

import geomkin as gk
from geomkin.export.cut import cut

pytest.importorskip("OCP", reason="no CAD kernel is installed")
RECIPES = sorted(Path("recipes").glob("*.toml"))


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.stem)
def test_each_part_is_a_sound_solid_of_exact_volume(path, tmp_path):
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum

    recipe = gk.load(path)
    for part in recipe.parts:
        if part.twist:
            with pytest.raises(gk.DesignError, match="take stl or 3mf"):
                gk.write(part, tmp_path / f"{part.name}.step", tolerance=recipe.files.tolerance)
            continue
        (written,) = gk.write(part, tmp_path / f"{part.name}.step", tolerance=recipe.files.tolerance)
        reader = STEPControl_Reader()
        reader.ReadFile(str(written))
        reader.TransferRoots()
        solid, found = reader.OneShape(), GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, found)
        expected = cut(part, recipe.files.tolerance, arcs=True).area * part.thickness
        assert solid.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID and BRepCheck_Analyzer(solid).IsValid()
        assert found.Mass() == pytest.approx(expected, rel=1e-9)
