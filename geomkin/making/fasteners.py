"""What holds plates on their pins, screws with nuts or rods: how far they stand out, and what is bought."""

from __future__ import annotations

from typing import Literal

from ..core.errors import DesignError
from ..core.records import record
from ..model.part import Bought


@record
class Size:
    """A metric thread; all in mm.

    screw, nut: what is bought, with its standard; head: diameter and height of the screw's; corners, height: of the
    nut; pitch: of the thread, by which the screw's end stands out of the nut at least; washer: outer diameter and
    thickness by ISO 7089; lengths: shortest and longest of the screws.
    """

    screw: str
    head: tuple[float, float]
    lengths: tuple[float, float]
    nut: str
    corners: float
    height: float
    pitch: float
    washer: tuple[float, float]

    @property
    def across(self) -> float:
        """Diameter of the widest thing at either end, mm."""
        return max(self.head[0], self.corners, self.washer[0])


ROUND, CAP = "button head screw ISO 7380-1", "cap screw ISO 4762"
LOCK, PLAIN = "lock nut ISO 7040", "nut ISO 4032"
# By diameter, largest sizes of the standards named. ISO 7380-1 and ISO 7040 begin at M3.
SIZES: dict[float, Size] = {
    2.0: Size(CAP, (3.8, 2.0), (3, 20), PLAIN, 4.32, 1.6, 0.4, (5.0, 0.3)),
    2.5: Size(CAP, (4.5, 2.5), (4, 25), PLAIN, 5.45, 2.0, 0.45, (6.0, 0.5)),
    3.0: Size(ROUND, (5.7, 1.65), (6, 30), LOCK, 6.01, 4.5, 0.5, (7.0, 0.5)),
    4.0: Size(ROUND, (7.6, 2.2), (8, 40), LOCK, 7.66, 6.0, 0.7, (9.0, 0.8)),
    5.0: Size(ROUND, (9.5, 2.75), (10, 50), LOCK, 8.79, 6.8, 0.8, (10.0, 1.0)),
    6.0: Size(ROUND, (10.5, 3.3), (10, 60), LOCK, 11.05, 8.0, 1.0, (12.0, 1.6)),
    8.0: Size(ROUND, (14.0, 4.4), (12, 80), LOCK, 14.38, 9.5, 1.25, (16.0, 1.6)),
}
# Sheets that a nut may be as high as. More are piles of spacers that nobody puts on a pin; fewer would leave thin card
# without screws.
MOST_SHEETS = 20
# Lengths in which screws are made, mm (ISO 888).
LENGTHS = (3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80)


@record
class Fastener:
    """How pins of one diameter are held.

    sort: a screw of a standard length with a nut and a washer under it; a threaded rod with a nut and a washer
    at either end, where no screw is long enough; or a plain rod, cut flush and glued or pressed into the plate at
    either end that moves with it. play: along the pin, mm, so that plates turn. head_height: mm, instead of the
    standard's.
    """

    diameter: float
    sort: Literal["screw", "rod"]
    play: float
    head_height: float | None = None

    @property
    def size(self) -> Size | None:
        """The thread, where there is one."""
        return SIZES.get(self.diameter)

    @property
    def across(self) -> float:
        """Diameter of what stands out at either end, mm."""
        return self.diameter if self.sort == "rod" or self.size is None else self.size.across

    def length(self, grip: float) -> float | None:
        """The standard length, mm, for plates of a thickness `grip`; None where it is a rod."""
        if self.sort == "rod" or self.size is None:
            return None
        least = self._threaded(self.size, grip)
        fit = [length for length in LENGTHS if max(least, self.size.lengths[0]) <= length <= self.size.lengths[1]]
        return float(fit[0]) if fit else None

    def ends(self, grip: float) -> tuple[float, float]:
        """How far head and nut stand out of plates of a thickness `grip` at most, mm."""
        if self.sort == "rod" or self.size is None:
            return 0.0, 0.0
        length = self.length(grip)
        if length is None:
            both = self.size.washer[1] + self.size.height + self.size.pitch + self.play
            return both, both
        head = self.size.head[1] if self.head_height is None else self.head_height
        return head + self.play, length - grip

    def bill(self, grip: float) -> tuple[tuple[str, int], ...]:
        """What one joint takes, each with its number."""
        if self.sort == "rod" or self.size is None:
            return ((f"rod {self.diameter:g} mm, cut to {grip + self.play:g} mm", 1),)
        thread, length = f"M{self.diameter:g}", self.length(grip)
        ends = 1 if length else 2
        held = (f"{thread} washer ISO 7089", ends), (f"{thread} {self.size.nut}", ends)
        if length is None:
            whole = self._threaded(self.size, grip) + self.size.washer[1] + self.size.height + self.size.pitch
            return (f"{thread} threaded rod DIN 976-1, cut to {whole:.1f} mm", 1), *held
        return (f"{thread} x {length:g} {self.size.screw}", 1), *held

    def _threaded(self, size: Size, grip: float) -> float:
        """Least length under the head, mm: plates, play, a washer, the nut, and a thread beyond it."""
        return grip + self.play + size.washer[1] + size.height + size.pitch


def fastener_of(
    diameter: float, thickness: float, sort: Literal["screw", "rod"] | None, play: float, head_height: float | None
) -> Fastener:
    """The fastener of a pin diameter and sheets of a thickness, mm.

    A screw wherever the diameter is a thread's, and its nut is not as high as a pile of sheets. DesignError for a screw
    that is none, or that is.
    """
    if sort == "screw" and diameter not in SIZES:
        sizes = ", ".join(f"{size:g}" for size in SIZES)
        raise DesignError(
            "fastener",
            f"found a screw, but no screw is {diameter:g} mm thick",
            f'give pin_diameter as one of {sizes}, or fastener = "rod"',
        )
    held = Fastener(diameter, "screw", play, head_height)
    thin = max(held.ends(thickness)) > MOST_SHEETS * thickness
    if sort == "screw" and thin:
        raise DesignError(
            "fastener",
            f"found a screw, whose nut is as high as {max(held.ends(thickness)) / thickness:.0f} sheets of the stock",
            f'give a thicker sheet, a thinner pin, or fastener = "rod": at most {MOST_SHEETS} sheets are left empty',
        )
    fits = diameter in SIZES and not thin
    return Fastener(diameter, sort or ("screw" if fits else "rod"), play, head_height)


def gathered(lines: list[tuple[str, tuple[tuple[str, int], ...]]]) -> tuple[Bought, ...]:
    """The bill of all joints, each with what it takes: like things in one line, in the order of first use."""
    found: dict[str, tuple[int, list[str]]] = {}
    for joint, things in lines:
        for name, count in things:
            number, joints = found.setdefault(name, (0, []))
            found[name] = number + count, joints if joint in joints else [*joints, joint]
    return tuple(Bought(name, count, tuple(joints)) for name, (count, joints) in found.items())
