"""The one table of formats. A new format is one file here, and one row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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

    needs: what it is made of. write: from a job to files by name. packages: those that have a hand in it, besides
    NumPy; the summary tells their versions. flat: it shows parts as a beam goes, half a kerf off them. ending: of its
    files, where that is not the format's name. asked: only written where a recipe names it.
    """

    needs: Literal["parts", "table", "scene"]
    write: Callable[[Job], Contents]
    packages: tuple[str, ...] = ()
    flat: bool = False
    ending: str = ""
    asked: bool = False


def _in(module: str) -> Callable[[Job], Contents]:
    """The function `write` of a module beside this one, loaded when first used: a DXF loads no meshes."""

    def write(job: Job) -> Contents:
        written: Contents = import_module(f".{module}", __package__).write(job)
        return written

    return write


# Name, mostly the ending too -> how it is written, in the order in which files come.
WRITERS: dict[str, Writer] = {
    "dxf": Writer("parts", _in("dxf"), ("shapely", "ezdxf"), flat=True),
    "stl": Writer("parts", _in("stl"), ("shapely", "trimesh")),
    "svg": Writer("parts", _in("svg"), ("shapely",), flat=True),
    "csv": Writer("table", _in("csv")),
    "step": Writer("parts", _in("step"), ("shapely",), asked=True),
    "page": Writer("scene", _in("page"), ending="html"),
}
# What is written where a recipe names no formats.
USUAL = tuple(name for name, writer in WRITERS.items() if not writer.asked)


def ending_of(name: str) -> str:
    """What the names of a format's files end in."""
    return WRITERS[name].ending or name


def format_of(ending: str) -> str:
    """The format whose files end so; "" for none."""
    return next((name for name in WRITERS if ending_of(name) == ending), "")
