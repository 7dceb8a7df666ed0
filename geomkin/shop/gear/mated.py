"""Stock of a gear and the mate that it shapes: the bores of both, each with its own fit and form."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from ...brief import one_line
from ...errors import DesignError
from ...plane.curve import AbstractCurve
from ...sizes import FARTHEST, quantity
from ..bore import shaft
from ..fits import AbstractBored, BoreForm, Fit, fit, flat_across, form, keyway_depth, keyway_width

# Keys of a bore that the mate has, too, under names of its own.
OWN = re.compile(r"\b(bore_form|bore|keyway_width|keyway_depth|flat)\b")


@dataclass(frozen=True)
class AbstractMated(AbstractBored):
    """What stock tables of a gear and its mate have in common; all lengths in mm.

    Clearance, interference and thickness are those of both; a ring has no bore. A motor turns the gear.
    """

    bore: float = shaft("the gear's shaft", 8.0, fitted=True)
    mate_bore: float = shaft("the mate's shaft", 8.0, fitted=True)
    mate_bore_form: BoreForm = form("the mate's bore")
    mate_flat: float | None = flat_across()
    mate_keyway_width: float = keyway_width("the mate's bore")
    mate_keyway_depth: float = keyway_depth("the mate's bore")
    mate_fit: Fit = fit("the mate's bore")
    rim: float = quantity("width of a ring outside its teeth", "mm", default=8.0, at_least=0.01, at_most=FARTHEST)

    __repr__ = one_line

    def __post_init__(self) -> None:
        super().__post_init__()
        with _of_mate():
            _ = self.mate

    @property
    def mate(self) -> AbstractBored:
        """The same of the mate, as that of a gear by itself."""
        return AbstractBored(
            thickness=self.thickness,
            bore=self.mate_bore,
            bore_form=self.mate_bore_form,
            flat=self.mate_flat,
            keyway_width=self.mate_keyway_width,
            keyway_depth=self.mate_keyway_depth,
            fit=self.mate_fit,
            interference=self.interference,
            clearance=self.clearance,
        )

    def mate_hole(self, towards: complex, widest: float, key: str) -> tuple[AbstractCurve, ...]:
        """The mate's bore about its axis, as `hole` is the gear's."""
        with _of_mate():
            return self.mate.hole(towards, widest, key)


@contextmanager
def _of_mate() -> Iterator[None]:
    """Refusals of a bore, by the names that its keys have for the mate."""
    try:
        yield
    except DesignError as error:
        table, dot, name = error.field.rpartition(".")
        field, remedy = OWN.sub(r"mate_\1", name), OWN.sub(r"mate_\1", error.remedy)
        problem = error.problem.replace("bore_form", "mate_bore_form")
        raise DesignError(f"{table}{dot}{field}", problem, remedy) from None
