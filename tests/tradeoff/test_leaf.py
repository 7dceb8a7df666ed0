"""The chart is a leaf: only the command and the face import it, and the inner names that it uses are these."""

import ast
from collections import defaultdict
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "geomkin"
# Names of other folders by module. Whoever renames one changes the chart too; whoever adds one says so here.
INNER = {
    "cam.base_circle": "least_base_circle",
    "cam.cam": "Cam",
    "cam.followers.flat": "OscillatingFlat TranslatingFlat",
    "cam.followers.roller": "OscillatingRoller TranslatingRoller",
    "cam.program.program": "Program",
    "cam.program.segments": "Dwell Return Rise",
    "core.arguments": "AnyFloat checked",
    "core.errors": "DesignError shown",
    "core.fields": "to_digits",
    "core.processes": "Watch",
    "core.records": "record",
    "core.version": "__version__",
    "export.cut": "cut",
    "export.dxf": "dxf",
    "export.layout": "lay_out",
    "export.solids": "stl",
    "export.tables": "csv",
    "export.text": "text",
    "gear.conjugate.conjugate": "conjugate",
    "gear.cutters": "RackCutter",
    "gear.pair": "GearPair",
    "gear.spur": "SpurGear Tooth",
    "linkage.instant.centres": "instant_centre",
    "linkage.instant.curvature": "path_curvature",
    "linkage.instant.inflection": "inflection_circle",
    "linkage.linkage": "Linkage",
    "linkage.motion": "Motion",
    "linkage.moving": "move placements_for",
    "linkage.named_linkages": "FourBar InvertedSliderCrank SliderCrank",
    "linkage.sampled": "central_difference mid_ordinate_integral velocity_difference",
    "linkage.six_bars": "StephensonSixBar",
    "linkage.solve.branch": "as_branch_spec",
    "linkage.solve.continuation": "newton_raphson",
    "linkage.solve.input_dyads": "CrankDriven",
    "linkage.solve.loops": "Loops",
    "linkage.solve.placement": "Timing",
    "linkage.solve.solution": "LinkageSolution",
    "linkage.tolerance_analysis": "DEVIATIONS tolerances",
    "model.part": "Part",
    "model.table": "Column Table",
    "page.page": "head player_file",
    "plane": "region",
    "plane.approximation": "to_arcs",
    "plane.curve": "AbstractCurve",
    "plane.flatten": "flatten",
    "plane.joined": "Path",
    "plane.primitives": "Arc Circle Polyline",
    "plane.roulettes": "Involute Trochoid roll_at",
    "plane.vec": "Array Complex Mask Pose Real Whole cross unit xy",
    "synthesis.function.function": "chebyshev_points function_generator",
    "synthesis.guidance.dyads": "dyads_through",
    "synthesis.guidance.poses": "circle_of_sliders poles",
    "synthesis.path.coupler_paths": "START bounds_of closing",
    "synthesis.path.fits": "PathTask polished_starts",
    "synthesis.path.nine_point_equations": "follow refine rotations_of",
    "synthesis.path.nine_points": "REAL starts_of through_nine",
    "synthesis.path.path": "LONGEST_RATIO TOGGLE_DEG path_generator",
    "synthesis.path.starts": "linear_fit random_linkages",
}


def imported(file):
    """Each name that a file imports from the package, with the parts of its module."""
    here = file.relative_to(PACKAGE).with_suffix("").parts
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            module = (*here[: len(here) - node.level], *(node.module.split(".") if node.module else ()))
            yield from ((module, name.name) for name in node.names)


def test_inner_names_that_the_chart_uses_are_frozen():
    used = defaultdict(set)
    for file in (PACKAGE / "tradeoff").rglob("*.py"):
        for module, name in imported(file):
            if module and module[0] != "tradeoff":
                used[".".join(module)].add(name)
    assert {module: " ".join(sorted(names)) for module, names in used.items()} == INNER


def test_only_the_command_and_the_face_import_the_chart():
    users = {
        file.relative_to(PACKAGE).parts[0]
        for file in [*PACKAGE.rglob("*.py"), PACKAGE / "__init__.pyi"]
        if "tradeoff" in file.read_text("utf-8")
        and any("tradeoff" in (*module[:1], name) for module, name in imported(file))
    }
    assert users - {"tradeoff"} == {"cli", "__init__.pyi"}
