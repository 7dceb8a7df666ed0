"""The table of formats. A new format is one function in this folder and one row."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from ..core.named import VIEWS, named

if TYPE_CHECKING:
    from .job import Job


# File name -> content.
Contents = Mapping[str, bytes]


@dataclass(frozen=True)
class Writer:
    """A format.

    Parameters
    ----------
    needs : {"parts", "table", "scene"}
        The data that it is made of.
    write : callable
        From a job to the contents of files by name.
    packages : tuple of str
        Packages used besides NumPy; the summary lists their versions.
    flat : bool
        Whether it contains the path of a cutting beam, half a kerf off the parts.
    tail : str
        Ending of its files' names after the recipe's name; by default a dot and the format's name.
    opt_in : bool
        Whether it is written only if a recipe names it.
    """

    needs: Literal["parts", "table", "scene"]
    write: Callable[[Job], Contents]
    packages: tuple[str, ...] = ()
    flat: bool = False
    tail: str = ""
    opt_in: bool = False


def _in(home: str) -> Callable[[Job], Any]:
    """The function `module:function` of this folder, or a view of the face.

    It is imported on first use, so that a DXF does not load the libraries for meshes.
    """
    return lambda job: named(VIEWS.get(home, f"{__package__}.{home}"))(job)


def _one_file(
    needs: Literal["parts", "table", "scene"], home: str, tail: str, packages: tuple[str, ...] = (), opt_in: bool = True
) -> Writer:
    """A format of a single file, named after the recipe, whose content the function `home` returns."""
    content = _in(home)
    return Writer(needs, lambda job: {f"{job.name}{tail}": content(job)}, packages, tail=tail, opt_in=opt_in)


# Writers by the name of the format, in the order in which files are listed. The name is mostly also the ending.
WRITERS: dict[str, Writer] = {
    "dxf": Writer("parts", _in("dxf:write_dxf"), ("shapely", "ezdxf"), flat=True),
    "stl": Writer("parts", _in("solids:write_stl"), ("shapely",)),
    "svg": Writer("parts", _in("svg:write_svg"), ("shapely",), flat=True),
    "csv": _one_file("table", "tables:table_file", ".csv", opt_in=False),
    "bom": _one_file("parts", "tables:bill_file", "-bom.csv", ("shapely",), opt_in=False),
    "page": _one_file("scene", "page", ".html", opt_in=False),
    "assembly-svg": _one_file("scene", "scene_svg:assembly_picture", "-assembly.svg", opt_in=False),
    # Opt-in, since users who send a folder's DXF files to be cut send all of them.
    "assembly-dxf": _one_file("scene", "dxf:assembly_drawing", "-assembly.dxf", ("shapely", "ezdxf")),
    "steps": _one_file("scene", "scene_svg:steps_picture", "-steps.svg"),
    "animation": _one_file("scene", "scene_svg:animation", "-animation.svg"),
    "plots": Writer("scene", _in("tables:write_plots"), tail="-plot.svg", opt_in=True),
    "glb": _one_file("scene", "solids:glb", "-assembly.glb", ("shapely", "trimesh")),
    "assembly-3mf": _one_file("scene", "solids:assembly_package", "-assembly.3mf", ("shapely",)),
    "sheet-dxf": _one_file("parts", "dxf:sheet", "-sheet.dxf", ("shapely", "ezdxf")),
    "sheet-svg": _one_file("parts", "svg:sheet", "-sheet.svg", ("shapely",)),
    "sheet-pdf": _one_file("parts", "report:sheet_pdf", "-sheet.pdf", ("shapely", "typst")),
    "report": Writer("scene", _in("report:write_report"), ("shapely", "typst"), tail="-report.pdf", opt_in=True),
    "report-md": Writer("scene", _in("report:write_markdown"), ("shapely",), tail="-report.md", opt_in=True),
    "3mf": Writer("parts", _in("solids:write_threemf"), ("shapely",), opt_in=True),
    "step": Writer("parts", _in("step:write_step"), ("shapely",), opt_in=True),
    "assembly-step": _one_file("scene", "step:assembly_step", "-assembly.step", ("shapely",)),
}
# Formats that are written if a recipe names none.
DEFAULT_FORMATS = tuple(name for name, writer in WRITERS.items() if not writer.opt_in)


def tail_of(name: str) -> str:
    """The ending of a format's files."""
    return WRITERS[name].tail or f".{name}"


def format_in(name: str, file: str) -> str:
    """The format of a file of the recipe of this name, to which the pictures of its report belong; "" for none."""
    rest = file.removeprefix(name)
    is_picture = rest.startswith("-report-") and rest.endswith(".svg") and not rest.endswith(tail_of("plots"))
    return "report-md" if is_picture else format_of(f"x{rest}")


def format_of(file: str, needs: Collection[str] = ("parts", "table", "scene")) -> str:
    """The format with the longest ending that a file name has, among those that need one of `needs`; "" for none."""
    ends = {name: tail_of(name) for name in WRITERS if WRITERS[name].needs in needs}
    fitting = [name for name, end in ends.items() if file.lower().endswith(end) and len(file) > len(end)]
    return max(fitting, key=lambda name: len(ends[name]), default="")
