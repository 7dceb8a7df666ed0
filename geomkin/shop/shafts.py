"""What gears and cams turn on, as it is bought: shafts, pins and keys."""

from __future__ import annotations

from math import ceil

from .base import BaseStock
from .fits import AbstractBored
from .motors import MOTORS
from .parallel_keys import PARALLEL_KEYS, key_of

# What one joint takes, each with its number.
Bill = tuple[tuple[str, int], ...]
# Narrowest and widest that room is kept for a shaft's collar, mm. Smaller ones, and a collar of DIN 705 stands out
# beyond its shaft or under the feet of a base; larger ones only lengthen shafts.
COLLARS = 8.0, 20.0


def shaft_bill(stock: AbstractBored, length: float, count: int = 1) -> Bill:
    """The shaft of a part, through plates of a length together, mm, and the key where the part has a keyway.

    A motor brings its own shaft, and screws. count: how many parts are made, each with its own. Nothing where the part
    has neither bore nor motor.
    """
    across, (width, _) = stock.across_flat, stock.keyway
    form = f"shaft {stock.bore:g} mm" if across is None else f"D-shaft {stock.bore:g} mm, {across:g} mm across its flat"
    key = ((_key(stock.bore, width, stock.thickness), count),) if width else ()
    if stock.motor is not None:
        face = MOTORS[stock.motor]
        held = f"motor {face.called}, {form}" if stock.bore else f"motor {face.called}"
        return (held, count), (face.screw(stock.thickness), 4 * count), *key
    return ((f"{form}, {_least(length)}", count), *key) if stock.bore else ()


def pin_bill(diameter: float, length: float, count: int = 1, what: str = "pin") -> Bill:
    """Round pins, or plain shafts, of a diameter through plates of a length together, mm; nothing for diameter 0."""
    return ((f"{what} {diameter:g} mm, {_least(length)}", count),) if diameter else ()


def screw_bill(base: BaseStock, length: float, count: int = 4) -> Bill:
    """Screws of a base, those of its corners where no count is given, through plates of a length together, mm."""
    return ((f"screw {base.screw:g} mm, {_least(length)}", count),) if base.screw else ()


def collar_width(diameter: float) -> float:
    """Room along a shaft or pin, mm, for its set collar: as much as the shaft is thick, in whole mm, within limits.

    Collars by DIN 705 A are no wider for shafts of 3 to 50 mm.
    """
    return float(min(max(ceil(diameter), COLLARS[0]), COLLARS[1]))


def collar_bill(diameter: float, count: int = 1) -> Bill:
    """Collars that are clamped on a shaft or pin by their own screws."""
    return ((f"shaft collar DIN 705 A, {diameter:g} mm", count),)


def tube_bill(diameter: float, height: float, count: int = 1) -> Bill:
    """Pieces of tube that keep plates on a shaft or screw apart; cut, printed or made of washers."""
    return ((f"tube {diameter:g} mm inside, cut to {float(f'{height:.10g}'):g} mm", count),)


def _least(length: float) -> str:
    # How far it stands out is known by who holds it.
    return f"at least {float(f'{length:.10g}'):g} mm long"


def _key(shaft: float, width: float, room: float) -> str:
    """The key for a keyway of a width in a part so thick, mm: the shaft's own, or another one that wide."""
    keys = [key for key in (key_of(shaft), *PARALLEL_KEYS) if key and key.width == width]
    return keys[0].bill(room) if keys else f"key {width:g} mm wide, cut to {room:g} mm"
