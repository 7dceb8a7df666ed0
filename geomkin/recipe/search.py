"""Kinds and recipes of the gallery by names that are nearly theirs, by other names, and by the words of a wish."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher

WORD = re.compile(r"[^\W_]+")
# Mechanisms that no kind makes, by a word of their names, and the kinds that come nearest.
NOT_OFFERED = {
    **dict.fromkeys(("worm", "harmonic", "strain"), "planetary or cycloidal-drive"),
    **dict.fromkeys(("bevel", "hypoid", "crown", "miter", "mitre"), "gear-pair"),
    **dict.fromkeys(("screw", "leadscrew", "ballscrew", "nut"), "rack-and-pinion"),
    **dict.fromkeys(("v", "flat", "rope", "cable", "capstan", "ribbed"), "belt-drive"),
    **dict.fromkeys(("escapement",), "ratchet"),
    **dict.fromkeys(("barrel", "cylindrical", "globoid"), "groove-cam"),
    **dict.fromkeys(("universal", "cardan", "hooke", "u", "cv"), "oldham-coupling"),
    **dict.fromkeys(("delta", "hexapod", "stewart", "scara", "robot", "spherical", "flexure", "compliant", "sarrus"),
                    "linkage"),
    **dict.fromkeys(("wobble", "swash"), "slider-crank"),
    **dict.fromkeys(("noncircular", "elliptical", "mutilated"), "gear-pair"),
}  # fmt: skip

# Other names of what a kind, or a recipe of the gallery, makes; of several in one name the first counts.
ALSO_KNOWN_AS = {
    "belt-drive": ("pulley", "timing belt", "toothed belt", "synchronous belt", "idler", "gt2", "htd"),
    "chain-drive": ("sprocket", "roller chain", "bicycle chain", "bike chain", "derailleur"),
    "planetary": ("epicyclic", "sun gear", "planet gear", "differential"),
    "cycloidal-drive": ("cycloidal gear", "cycloidal reducer", "cycloidal gearbox", "cyclo"),
    "rack-and-pinion": ("linear gear",),
    "ring-gear": ("annulus",),
    "lantern-gears": ("pin gear", "pin wheel", "cage gear"),
    "gear-train": ("gearbox", "gear box", "reducer", "reduction", "compound gear", "motion work", "clockwork"),
    "geneva": ("maltese", "indexer", "intermittent", "indexing"),
    "ratchet": ("pawl", "freewheel", "one way clutch"),
    "groove-cam": ("face cam", "track cam", "box cam", "desmodromic"),
    "disk-cam": ("plate cam", "camshaft", "snail cam", "eccentric", "follower"),
    "slider-crank": ("piston", "engine", "crankshaft"),
    "inverted-slider-crank": ("oscillating cylinder",),
    "watt-six-bar": ("6 bar",),
    "four-bar": ("4 bar", "pumpjack", "pump jack", "ackermann", "steering"),
    "linkage": ("5 bar", "five bar", "8 bar", "eight bar", "bell crank"),
    "elliptic-trammel": ("ellipsograph", "trammel of archimedes", "tusi"),
    "fit-test": ("kerf", "tolerance coupon"),
    "lift-table": ("scissor", "lazy tong"),
    "walker": ("strandbeest",),
    "peaucellier": ("hart",),
}


def other_names(*names: str) -> str:
    """Other names of kinds and recipes, by which they are searched."""
    return " ".join(other for name in names for other in ALSO_KNOWN_AS.get(name, ()))


# Words of a wish that say nothing about a mechanism, and endings that are left out if four letters stay.
FILLERS = frozenset(
    re.findall(
        "[a-z]+",
        "a an and are as at be by can for from have i in into is it its mechanism motion need of on one or some "
        "something someone that the thing this to want which with",
    )
)
ENDINGS, STEM = ("ing", "ed", "es", "s"), 4
# The limit of a value, which says nothing about a mechanism either.
LIMIT = re.compile(r"\b(?:(?:less|more) than|at (?:least|most)|below|under|above|over) [0-9]\S*")
# Largest number of recipes of the gallery that a message names, and of texts that half of a wish finds.
MOST_RECIPES = 8


def wished(wish: str, texts: Mapping[str, str]) -> list[str]:
    """Names of the texts with all words of a wish or, if none has, with most of them; else none.

    Half of them is enough if a word is in the name, for a few.
    """
    words = WORD.findall(LIMIT.sub("", wish.casefold()))
    wanted = [_stem(word) for word in [word for word in words if word not in FILLERS] or words]

    def count(text: str) -> int:
        known = set(WORD.findall(text.casefold()))
        # A short word is a whole one.
        return sum(
            word in known if len(word) < 3 else any(other.startswith(word) for other in known) for word in wanted
        )

    counts = {name: count(text) for name, text in texts.items()}
    most = max(counts.values(), default=0)
    best = [name for name in texts if counts[name] == most]
    if 2 * most > len(wanted) or not wish:
        return best
    named = [name for name in best if 2 * most == len(wanted) and count(name)]
    # Of what no kind makes a message names the nearest.
    return named if len(named) <= MOST_RECIPES and NOT_OFFERED.keys().isdisjoint(words) else []


def _stem(word: str) -> str:
    ending = next((end for end in ENDINGS if word.endswith(end) and len(word) - len(end) >= STEM), "")
    return word.removesuffix(ending)


def nearest_kind(name: object, kinds: Iterable[str]) -> str:
    """The start of a remedy for an unknown kind: what was meant, recipes of the gallery, or the nearest kinds."""
    from .kinds import gallery

    meant = did_you_mean(name, kinds)
    words = WORD.findall(name[:100].lower()) if isinstance(name, str) else []
    if not meant and (nearest := next((NOT_OFFERED[word] for word in words if word in NOT_OFFERED), "")):
        return f"geomkin makes planar mechanisms, but not this one; nearest to it is {nearest}; "
    also = "" if meant else next((one for one, names in ALSO_KNOWN_AS.items() if _has_phrase(words, names)), "")
    if also in kinds:
        return f"did you mean {also}? "
    words = [word for word in words if word not in FILLERS]
    known = {file.removesuffix(".toml"): about.lower() for file, (_, about) in gallery()[1].items()}

    def is_meant(recipe: str) -> bool:
        """Whether the name has the recipe's, or is nearly it, or all its words describe the recipe."""
        described = WORD.findall(f"{recipe} {known[recipe]}")
        is_described = all(any(other.startswith(word) for other in described) for word in words)
        return recipe in words or (not meant and (is_described or bool(did_you_mean(name, [recipe]))))

    named = [recipe for recipe in known if words and recipe not in kinds and is_meant(recipe)][:MOST_RECIPES]
    named = [also] if also in known else named
    if named:
        return f"{meant}the gallery has {', '.join(named)}, which `geomkin new {named[0]}` prints; "
    return meant


def _has_phrase(words: list[str], phrases: Iterable[str]) -> bool:
    """Whether one of the phrases, or its plural, is among the words of a name."""
    return any(re.search(rf"\b{phrase}s?\b", " ".join(words)) for phrase in phrases)


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """The start of a remedy, `did you mean ...? `, if a known name is similar; otherwise "".

    Two names are similar if they are spelt alike, or if each word of the shorter one is similar to a word of the other:
    a planetary gear is a planetary. A single common word is not enough: a worm gear is no spur gear.
    """
    if not isinstance(name, str) or not (words := WORD.findall(name[:100].lower())):
        return ""
    similarity = {other: _similarity(words, WORD.findall(other.lower())) for other in known}
    best = max(similarity, key=lambda other: similarity[other], default="")
    return f"did you mean {best}? " if best and similarity[best] else ""


def _similarity(words: list[str], others: list[str]) -> float:
    """Similarity of two names, 0 to 1; 0 if neither is a misspelling of the other."""

    def ratio(a: str, b: str) -> float:
        return SequenceMatcher(None, a, b).ratio()

    def is_similar(word: str, other: str) -> bool:
        has_swapped_letters = sorted(word) == sorted(other)
        return has_swapped_letters or ratio(word, other) >= (0.6 if max(len(word), len(other)) < 5 else 0.82)

    whole = ratio("".join(words), "".join(others))
    has_all_words = all(any(is_similar(word, other) for other in others) for word in words)
    # One of several words may be the name of something else.
    is_within = whole >= 0.6 and all(any(is_similar(word, other) for word in words) for other in others)
    # The same words are nearer than a similar spelling: a pdf is a sheet-pdf rather than a dxf.
    same = float(set(words) <= set(others))
    return same + whole if same or has_all_words or is_within or whole >= 0.85 else 0.0
