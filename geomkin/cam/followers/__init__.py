"""What rides on a cam: the table of followers that a recipe may name. A new one is one class, and one row here."""

from .flat import OscillatingFlat, TranslatingFlat
from .follower import FOLLOWERS
from .roller import OscillatingRoller, TranslatingRoller

FOLLOWERS.update({
    "translating-roller": TranslatingRoller,
    "translating-flat": TranslatingFlat,
    "oscillating-roller": OscillatingRoller,
    "oscillating-flat": OscillatingFlat,
})  # fmt: skip
