"""The size of teeth: a module, or the diametral pitch that gives it."""

from __future__ import annotations

from typing import Annotated, Any

from ..core.arguments import NUMBER, ArgumentType
from ..core.errors import DesignError
from ..core.fields import SMALLEST, quantity
from ..core.units import INCH

# Largest module, mm.
LARGEST = 1e5
# A number that may be omitted if it follows from another one; always set in a finished gear.
Settled = Annotated[float, ArgumentType(lambda value: value is None or NUMBER.fits(value), NUMBER.allowed)]


def module(meaning: str = "pitch diameter per tooth", example: float = 2) -> Any:
    """The field for a module; `settle_module` sets it if it is omitted."""
    return quantity(meaning, "mm", default=None, above=0, at_most=LARGEST, example=example)


def diametral_pitch() -> Any:
    """The field for the diametral pitch, an alternative to the module."""
    return quantity("teeth per inch of pitch diameter", "1/in", default=None, above=0, at_most=1e5)


def settle_module(gear: Any) -> None:
    """Set the module of a gear from its diametral pitch. Raises DesignError if it has neither, or both disagree."""
    if gear.diametral_pitch is None:
        if gear.module is None:
            raise DesignError("module", "found neither module nor diametral_pitch", "give one of them", "missing-key")
        return
    module = INCH / gear.diametral_pitch
    if gear.module is not None and abs(gear.module - module) > 1e-9 * module:
        raise DesignError(
            "module",
            f"found {gear.module:g} mm, but a diametral_pitch of {gear.diametral_pitch:g} means {module:.6g} mm",
            "give one of them",
            "conflict",
        )
    object.__setattr__(gear, "module", module)
    if not SMALLEST <= module <= LARGEST:
        raise DesignError(
            "diametral_pitch",
            f"found {gear.diametral_pitch:g}, which means a module of {module:.6g} mm",
            f"give {INCH / LARGEST:g} to 1e5",
            "out-of-range",
            INCH / LARGEST if module > LARGEST else 1e5,
        )
