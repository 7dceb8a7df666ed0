"""The table of formats. A new format is one file here and one row."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Literal

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


def _in(home: str) -> Callable[[Job], Contents]:
    """The function `module:function`, imported on first use, so that a DXF does not load the libraries for meshes."""
    module, _, name = home.partition(":")

    def write(job: Job) -> Contents:
        written: Contents = getattr(import_module(f"geomkin.{module}"), name)(job)
        return written

    return write


# Writers by the name of the format, in the order in which files are listed. The name is mostly also the ending.
WRITERS: dict[str, Writer] = {
    "dxf": Writer("parts", _in("export.dxf:write_dxf"), ("shapely", "ezdxf"), flat=True),
    "stl": Writer("parts", _in("export.stl:write_stl"), ("shapely",)),
    "svg": Writer("parts", _in("export.svg:write_svg"), ("shapely",), flat=True),
    "csv": Writer("table", _in("export.csv:write_csv")),
    "bom": Writer("parts", _in("export.csv:write_bom"), ("shapely",), tail="-bom.csv"),
    "page": Writer("scene", _in("page.page:write_page"), tail=".html"),
    "assembly-svg": Writer("scene", _in("export.assembly_svg:write_assembly_svg"), tail="-assembly.svg"),
    # Opt-in, since users who send a folder's DXF files to be cut send all of them.
    "assembly-dxf": Writer(
        "scene", _in("export.assembly_dxf:write_assembly_dxf"), ("shapely", "ezdxf"), tail="-assembly.dxf", opt_in=True
    ),
    "steps": Writer("scene", _in("export.steps_svg:write_steps_svg"), tail="-steps.svg", opt_in=True),
    "animation": Writer("scene", _in("export.animation:write_animation"), tail="-animation.svg", opt_in=True),
    "plots": Writer("scene", _in("export.plots:write_plots"), tail="-plot.svg", opt_in=True),
    "glb": Writer("scene", _in("export.glb:write_glb"), ("shapely", "trimesh"), tail="-assembly.glb", opt_in=True),
    "assembly-3mf": Writer(
        "scene", _in("export.threemf:write_assembly_3mf"), ("shapely",), tail="-assembly.3mf", opt_in=True
    ),
    "sheet-dxf": Writer(
        "parts", _in("export.dxf:write_sheet_dxf"), ("shapely", "ezdxf"), tail="-sheet.dxf", opt_in=True
    ),
    "sheet-svg": Writer("parts", _in("export.svg:write_sheet_svg"), ("shapely",), tail="-sheet.svg", opt_in=True),
    "3mf": Writer("parts", _in("export.threemf:write_3mf"), ("shapely",), opt_in=True),
    "step": Writer("parts", _in("export.step:write_step"), ("shapely",), opt_in=True),
}
# Formats that are written if a recipe names none.
DEFAULT_FORMATS = tuple(name for name, writer in WRITERS.items() if not writer.opt_in)


def tail_of(name: str) -> str:
    """The ending of a format's files."""
    return WRITERS[name].tail or f".{name}"


def format_of(file: str, needs: Collection[str] = ("parts", "table", "scene")) -> str:
    """The format with the longest ending that a file name has, among those that need one of `needs`; "" for none."""
    ends = {name: tail_of(name) for name in WRITERS if WRITERS[name].needs in needs}
    fitting = [name for name, end in ends.items() if file.lower().endswith(end) and len(file) > len(end)]
    return max(fitting, key=lambda name: len(ends[name]), default="")
