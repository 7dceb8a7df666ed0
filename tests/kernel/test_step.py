"""STEP files of the whole gallery as a CAD kernel reads them. Needs the extra `kernel`."""

from dataclasses import replace
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.export.job import Job
from geomkin.export.still import in_place
from geomkin.plane.measure import area, length

pytest.importorskip("OCP", reason="no CAD kernel is installed")
# Share of the tolerance that chords of the triangles may deviate.
CHORDS = 0.5
RECIPES = sorted(Path("recipes").glob("*.toml"))


def as_read(path, tolerance):
    """The solid in a file, its volume, mm3, and its number of faces."""
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    solid, found = reader.OneShape(), GProp_GProps()
    # By triangles, since the kernel integrates faces between splines only within a thousandth.
    BRepMesh_IncrementalMesh(solid, CHORDS * tolerance, False, 0.5, False)
    BRepGProp.VolumeProperties_s(solid, found, False, False, True)
    faces, count = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_FACE), 0
    while faces.More():
        faces.Next()
        count += 1
    return solid, found.Mass(), count


def is_sound(solid):
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopAbs import TopAbs_ShapeEnum

    return solid.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID and BRepCheck_Analyzer(solid).IsValid()


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.stem)
def test_each_part_is_a_sound_solid_of_exact_volume(path, tmp_path):
    recipe = gk.load(path)
    tolerance = recipe.files.tolerance
    for part in recipe.parts:
        (written,) = gk.write(part, tmp_path / f"{part.name}.step", tolerance=tolerance)
        solid, volume, _ = as_read(written, tolerance)
        curves = (part.outline, *part.holes)
        exact = (area(curves[0]) - sum(map(area, curves[1:]))) * part.thickness
        # Splines keep a fifth of the tolerance.
        allowed = (0.2 + CHORDS) * tolerance * sum(map(length, curves)) * part.thickness + 1e-9 * exact
        assert is_sound(solid), part.name
        assert volume == pytest.approx(exact, abs=allowed), part.name


@pytest.mark.parametrize("herringbone", [False, True])
def test_helical_gear_of_24_teeth_is_one_solid_with_few_faces(tmp_path, herringbone):
    gear = {"helix_angle_deg": 25, "herringbone": herringbone, "gear": {"teeth": 24, "module": 2}}
    recipe = gk.load({"kind": "spur-gear", **gear, "stock": {"thickness": 20, "bore": 10}})
    (written,) = gk.write(recipe.parts, tmp_path / "gear.step")
    solid, _, faces = as_read(written, 0.05)
    assert is_sound(solid) and faces == (196 if herringbone else 100)


@pytest.mark.parametrize("name", ["crank-rocker", "herringbone-pair", "walking-leg"])
def test_assembly_has_its_parts_in_place_with_names_and_colours(name, tmp_path):
    from OCP.BRepGProp import BRepGProp
    from OCP.collections import Sequence_TDF_Label
    from OCP.GProp import GProp_GProps
    from OCP.Quantity import Quantity_Color
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    recipe = gk.load(f"recipes/{name}.toml")
    (written,) = gk.write(recipe, tmp_path / "a-assembly.step")
    _, placements = in_place(Job(name, recipe, recipe.files.tolerance))
    document, reader = TDocStd_Document(TCollection_ExtendedString("XCAF")), STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    assert reader.ReadFile(str(written)) and reader.Transfer(document)
    shapes, colours = (
        tool(document.Main()) for tool in (XCAFDoc_DocumentTool.ShapeTool_s, XCAFDoc_DocumentTool.ColorTool_s)
    )
    roots, labels = Sequence_TDF_Label(), Sequence_TDF_Label()
    shapes.GetFreeShapes(roots)
    assert roots.Length() == 1
    XCAFDoc_ShapeTool.GetComponents_s(roots.Value(1), labels)
    assert labels.Length() == len(placements)
    for label, placement in zip((labels.Value(k + 1) for k in range(len(placements))), placements):
        given, found, colour = TDataStd_Name(), GProp_GProps(), Quantity_Color()
        assert label.FindAttribute(TDataStd_Name.GetID_s(), given) and given.Get().ToExtString() == placement.name
        solid = XCAFDoc_ShapeTool.GetShape_s(label)
        BRepGProp.VolumeProperties_s(solid, found)
        centre = found.CentreOfMass()
        material = gk.making.material("steel-S235")
        part = replace(placement.part, material=material)
        expected = placement.origin + placement.direction * part.mass.centre
        assert abs(complex(centre.X(), centre.Y()) - expected) < 0.01
        assert centre.Z() == pytest.approx(placement.height + part.thickness / 2, abs=0.01)
        whole = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, whole)
        assert colours.GetColor(XCAFDoc_ShapeTool.GetShape_s(whole), XCAFDoc_ColorSurf, colour)
        # The kernel's colours are linear; those of the file are as on screens.
        assert max(colour.Red(), colour.Green(), colour.Blue()) > 0
