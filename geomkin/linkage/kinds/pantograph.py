"""Recipes of pantographs."""

from __future__ import annotations

from typing import Literal

from ...core.records import record
from ..pantograph import Pantograph
from .linkages import TurningLinkageRecipe


@record(kw_only=True)
class PantographRecipe(TurningLinkageRecipe):
    """A pantograph: its pen copies the tracer's path, enlarged."""

    kind: Literal["pantograph"] = "pantograph"
    linkage: Pantograph
