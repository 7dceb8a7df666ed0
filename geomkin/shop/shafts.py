"""What gears and cams turn on, as it is bought: shafts, pins and keys."""

from __future__ import annotations

from .base import BaseStock
from .fits import AbstractBored
from .motors import MOTORS
from .parallel_keys import PARALLEL_KEYS, key_of

# What one joint takes, each with its number.
Bill = tuple[tuple[str, int], ...]


def shaft_bill(
    stock: AbstractBored, length: float, count: int = 1, base: float = 0.0, keys: int = 1, is_cut: bool = False
) -> Bill:
    """The shaft of a part, through plates of a length together, mm, and the key where the part has a keyway.

    A motor brings its own shaft, and screws: countersunk ones in a base, mm thick, on which others turn, 0 for none.
    count: how many such shafts there are, each with a motor of its own; keys: on each of them. is_cut: the shaft over a
    base is no longer than that. Nothing where the part has neither bore nor motor.
    """
    across, (width, _) = stock.across_flat, stock.keyway
    form = f"shaft {stock.bore:g} mm" if across is None else f"D-shaft {stock.bore:g} mm, {across:g} mm across its flat"
    key = ((_key(stock.bore, width, stock.thickness), count * keys),) if width else ()
    if stock.motor is not None:
        face = MOTORS[stock.motor]
        long = f"cut to {_shown(length)} mm from its face" if is_cut else _least(length)
        held = ", ".join([f"motor {face.called}", *([form] if stock.bore else []), *([long] if base else [])])
        return (held, count), (face.screw(base or stock.thickness, sunk=base > 0), 4 * count), *key
    return ((f"{form}, {_least(length)}", count), *key) if stock.bore else ()


def pin_bill(diameter: float, length: float, count: int = 1, what: str = "pin") -> Bill:
    """Round pins, or plain shafts, of a diameter through plates of a length together, mm; nothing for diameter 0."""
    return ((f"{what} {diameter:g} mm, {_least(length)}", count),) if diameter else ()


def screw_bill(base: BaseStock, length: float, count: int = 4) -> Bill:
    """Screws of a base, those of its corners where no count is given, through plates of a length together, mm."""
    return ((f"screw {base.screw:g} mm, {_least(length)}", count),) if base.screw else ()


def _least(length: float) -> str:
    # How far it stands out is known by who holds it.
    return f"at least {_shown(length)} mm long"


def _shown(length: float) -> str:
    return f"{float(f'{length:.10g}'):g}"


def _key(shaft: float, width: float, room: float) -> str:
    """The key for a keyway of a width in a part so thick, mm: the shaft's own, or another one that wide."""
    keys = [key for key in (key_of(shaft), *PARALLEL_KEYS) if key and key.width == width]
    return keys[0].bill(room) if keys else f"key {width:g} mm wide, cut to {room:g} mm"
