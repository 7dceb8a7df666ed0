"""The followers of cams, and the table of their kinds. A new follower is one class and one row here."""

from .flat import OscillatingFlat, TranslatingFlat
from .follower import FOLLOWERS
from .roller import OscillatingRoller, TranslatingRoller

FOLLOWERS.update({
    "translating-roller": TranslatingRoller,
    "translating-flat": TranslatingFlat,
    "oscillating-roller": OscillatingRoller,
    "oscillating-flat": OscillatingFlat,
})  # fmt: skip
