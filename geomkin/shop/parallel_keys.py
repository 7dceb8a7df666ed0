"""Parallel keys by the shaft's diameter: their sections, the keyways for them, and the lengths that are sold."""

from __future__ import annotations

from dataclasses import dataclass

from ..brief import one_line


@dataclass(frozen=True)
class ParallelKey:
    """A key of one section; all in mm.

    thickest: shaft that takes it. width, height: of the key; the width is that of its keyways. shaft_depth: of the
    keyway in the shaft; hub_depth: of that in the part, beyond the bore, along its middle. lengths: shortest and
    longest.
    """

    thickest: float
    width: float
    height: float
    shaft_depth: float
    hub_depth: float
    lengths: tuple[float, float]

    __repr__ = one_line

    def bill(self, room: float) -> str:
        """What is bought for a part so thick, mm: the longest key that is sold and fits, or a piece of bar."""
        section = f"{self.width:g} x {self.height:g}"
        most = min(room, self.lengths[1])
        fitting = [length for length in LENGTHS if self.lengths[0] <= length <= most]
        if not fitting:
            return f"key steel DIN 6880 {section}, cut to {room:g} mm"
        return f"parallel key DIN 6885-1 A {section} x {fitting[-1]:g}"


# The thinnest shaft that takes a key, mm.
THINNEST = 6.0
# By shafts up to so many mm, the high form. Another number here, and no key that is sold fits the keyway.
# Source: DIN 6885-1, table 1, the same as ISO 773; sections and depths compared with Flender's catalogue MD 30.1,
# lengths up to a width of 16 mm with the table at engineeringhardware.com/guide/standard/din-6885-parallel-keys.
PARALLEL_KEYS = tuple(
    ParallelKey(*row)
    for row in (
        (8, 2, 2, 1.2, 1.0, (6, 20)),
        (10, 3, 3, 1.8, 1.4, (6, 36)),
        (12, 4, 4, 2.5, 1.8, (8, 45)),
        (17, 5, 5, 3.0, 2.3, (10, 56)),
        (22, 6, 6, 3.5, 2.8, (14, 70)),
        (30, 8, 7, 4.0, 3.3, (18, 90)),
        (38, 10, 8, 5.0, 3.3, (22, 110)),
        (44, 12, 8, 5.0, 3.3, (28, 140)),
        (50, 14, 9, 5.5, 3.8, (36, 160)),
        (58, 16, 10, 6.0, 4.3, (45, 180)),
        (65, 18, 11, 7.0, 4.4, (50, 200)),
        (75, 20, 12, 7.5, 4.9, (56, 220)),
        (85, 22, 14, 9.0, 5.4, (63, 250)),
        (95, 25, 14, 9.0, 5.4, (70, 280)),
        (110, 28, 16, 10.0, 6.4, (80, 320)),
        (130, 32, 18, 11.0, 7.4, (90, 360)),
        (150, 36, 20, 12.0, 8.4, (100, 400)),
        (170, 40, 22, 13.0, 9.4, (100, 400)),
        (200, 45, 25, 15.0, 10.4, (110, 400)),
        (230, 50, 28, 17.0, 11.4, (125, 400)),
    )
)
# Lengths in which keys are sold, mm: DIN 6885-1 as ZAE's catalogue E 040 prints it. Between 280 and 400 mm it has 315
# and 355, other tables 320 and 360: none of these is named, for a shorter key fits as well.
LENGTHS = (
    6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 56, 63, 70, 80,
    90, 100, 110, 125, 140, 160, 180, 200, 220, 250, 280, 400,
)  # fmt: skip


def key_of(shaft: float) -> ParallelKey | None:
    """The key for a shaft of a diameter, mm; None where the standard has none.

    A range's upper end belongs to it: a shaft of 10 mm takes a key 3 mm wide.
    """
    if shaft < THINNEST:
        return None
    return next((key for key in PARALLEL_KEYS if shaft <= key.thickest), None)
