"""A linkage of any kind as one table of a recipe, selected by its `kind`, and one of its bodies by its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, fields, make_dataclass
from typing import Any, Literal, get_type_hints

import numpy as np

from ...core.arguments import ArgumentType
from ...core.errors import DesignError, shown
from ...core.field_visitor import WrittenForm
from ...model.table import Column
from ...recipe.settings import Stroke
from ..linkage import LINKAGES, AbstractLinkage
from ..motion import on_ground
from ..named_linkages import FourBar, SliderCrank
from . import linkage_kinds
from .moved import AbstractMovedRecipe

# The kinds that such a table may have. A scotch yoke has no body that turns and is not on a ground pivot.
OF = (
    linkage_kinds.FourBarRecipe,
    linkage_kinds.SliderCrankRecipe,
    linkage_kinds.InvertedSliderCrankRecipe,
    linkage_kinds.StephensonSixBarRecipe,
    linkage_kinds.WattSixBarRecipe,
    linkage_kinds.ShaperRecipe,
    linkage_kinds.EllipticTrammelRecipe,
    linkage_kinds.OldhamCouplingRecipe,
    linkage_kinds.LinkageRecipe,
)
PLAIN: dict[str, type[AbstractLinkage]] = {recipe.kind: get_type_hints(recipe)["linkage"] for recipe in OF}
DEFAULT_KIND = linkage_kinds.FourBarRecipe.kind
for _kind, _plain in PLAIN.items():
    _own = [("kind", Literal[_kind], field(default=_kind))]
    _about = {"__doc__": _plain.__doc__, "__module__": __name__}
    LINKAGES[_kind] = make_dataclass(
        f"{_plain.__name__}Table", _own, bases=(_plain,), namespace=_about, frozen=True, kw_only=True, repr=False
    )


def with_kind(linkage: AbstractLinkage) -> AbstractLinkage:
    """The linkage as the table of a recipe, which has its `kind`."""
    kind = next(kind for kind, plain in PLAIN.items() if isinstance(linkage, plain))
    return LINKAGES[kind](**_values(linkage, PLAIN[kind]))


def without_kind(table: AbstractLinkage) -> AbstractLinkage:
    """The linkage of a table, as the library has it."""
    plain = type(table).__mro__[1]
    return plain(**_values(table, plain))  # type: ignore[no-any-return]


def _values(linkage: AbstractLinkage, plain: type[Any]) -> dict[str, Any]:
    return {f.name: getattr(linkage, f.name) for f in fields(plain)}


class AnyKind(ArgumentType, WrittenForm):
    """Marks a linkage of any kind in `LINKAGES`; in a recipe a table with its `kind`, in Python the linkage itself."""

    def __init__(self) -> None:
        def fits(value: Any) -> bool:
            return any(isinstance(value, plain) and not value.linkage.is_batch for plain in PLAIN.values())

        super().__init__(fits, f"one linkage: {', '.join(plain.__name__ for plain in PLAIN.values())}")

    def read(self, given: Any, folder: Any) -> Any:
        return {"kind": DEFAULT_KIND, **given} if isinstance(given, dict) else given

    def finished(self, value: Any) -> Any:
        return without_kind(value)

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        return {"kind": "", **write(with_kind(value))}

    def schema(self, of_type: dict[str, Any]) -> dict[str, Any]:
        for choice in of_type["allOf"]:
            if choice["if"]["properties"]["kind"]["const"] == DEFAULT_KIND:
                choice["if"]["required"] = []
        return of_type | {"required": []}


# The example in templates.
EXAMPLE = with_kind(FourBar(100, 30, 90, 70, 40 + 25j))


class AbstractBodyRecipe(AbstractMovedRecipe):
    """Base class of recipes about the motion of one body of any linkage."""

    body: str

    def __post_init__(self) -> None:
        super().__post_init__()
        general = self.linkage.linkage
        moving = [name for name in general.bodies if name != general.ground]
        if self.body not in moving:
            raise DesignError("body", f"found {shown(self.body)}", f"give one of {', '.join(moving)}", "unknown-key")

    @property
    def drive_column(self) -> Column:
        """First column of the table."""
        if self.stroke:
            return Column("drive_place", "mm", "displacement of the driver along its line", self.motion.drive)
        words = "angle of the driver from the ground line"
        return Column("drive_angle", "deg", words, np.degrees(self.motion.drive))

    @property
    def what(self) -> str:
        """Name of the driver's range, for the check that it is reached."""
        return f"driver's {'stroke' if self.stroke else 'turn'}"

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        if "stroke" in tables:
            slider_crank = SliderCrank(30, 40, coupler_point=20 + 15j, driver="slider")
            return {"linkage": with_kind(slider_crank), "stroke": Stroke(start=50, end=68)}
        if "linkage" not in tables:
            return {}
        from ...recipe.template import example

        linkage: AbstractLinkage = example(LINKAGES[tables["linkage"]])
        general = linkage.linkage
        free = [name for name in general.bodies if name not in {*on_ground(general), general.ground}]
        return {"linkage": linkage, "body": "coupler" if "coupler" in general.bodies else free[0]}
