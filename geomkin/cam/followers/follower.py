"""The followers that a cam can have."""

from __future__ import annotations

from typing import Annotated

from ...sizes import OneOfKinds
from .flat import OscillatingFlat, TranslatingFlat
from .roller import OscillatingRoller, TranslatingRoller

Roller = TranslatingRoller | OscillatingRoller
Flat = TranslatingFlat | OscillatingFlat
Follower = Annotated[TranslatingRoller | TranslatingFlat | OscillatingRoller | OscillatingFlat, OneOfKinds()]

__all__ = [
    "Flat", "Follower", "OscillatingFlat", "OscillatingRoller", "Roller", "TranslatingFlat", "TranslatingRoller"
]  # fmt: skip
