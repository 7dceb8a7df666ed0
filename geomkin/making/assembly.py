"""What gears and cams turn on, as it is bought: shafts, pins and keys."""

from __future__ import annotations

from math import ceil

from ..core.records import record
from ..model.part import Bought
from .bases import BaseStock
from .bores import PARALLEL_KEYS, key_of
from .fasteners import SIZES, Fastener, gathered
from .fits import AbstractBored
from .motors import MOTORS, Motor, MotorName, fixed_under

# What one joint takes, each with its number.
Bill = tuple[tuple[str, int], ...]
# Narrowest and widest that room is kept for a shaft's collar, mm. Smaller ones, and a collar of DIN 705 stands out
# beyond its shaft or under the feet of a base; larger ones only lengthen shafts.
COLLARS = 8.0, 20.0
# Least width across, mm: the collar for a pin of 3 mm is 7 mm wide, and a smaller one would meet what is beside it.
NARROWEST = 8.0


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


def collar_width(diameter: float) -> float:
    """Room along a shaft or pin, mm, for its set collar: as much as the shaft is thick, in whole mm, within limits.

    Collars by DIN 705 A are no wider for shafts of 3 to 50 mm.
    """
    return float(min(max(ceil(diameter), COLLARS[0]), COLLARS[1]))


def collar_across(diameter: float) -> float:
    """Room across a shaft or pin, mm, for its set collar. Those of DIN 705 A for 3 to 50 mm are no wider."""
    return max(2 * diameter, NARROWEST)


def collar_bill(diameter: float, count: int = 1) -> Bill:
    """Collars that are clamped on a shaft or pin by their own screws."""
    return ((f"shaft collar DIN 705 A, {diameter:g} mm", count),)


def tube_bill(diameter: float, height: float, count: int = 1) -> Bill:
    """Pieces of tube that keep plates on a shaft or screw apart; cut, printed or made of washers."""
    return ((f"tube {diameter:g} mm inside, cut to {float(f'{height:.10g}'):g} mm", count),)


def _least(length: float) -> str:
    # How far it stands out is known by who holds it.
    return f"at least {_shown(length)} mm long"


def _shown(length: float) -> str:
    return f"{float(f'{length:.10g}'):g}"


def _key(shaft: float, width: float, room: float) -> str:
    """The key for a keyway of a width in a part so thick, mm: the shaft's own, or another one that wide."""
    keys = [key for key in (key_of(shaft), *PARALLEL_KEYS) if key and key.width == width]
    return keys[0].bill(room) if keys else f"key {width:g} mm wide, cut to {room:g} mm"


# mm left free under what turns under a base, so that it does not rub on what the base stands on.
FREE = 2.0
# mm along a shaft or between two discs, so that what is held between them turns. Less jams when the sheet is thicker
# than it says; more lets wheels lean.
PLAY = 0.5


@record
class Assembly:
    """What a mechanism takes besides its parts, and how all of it is put together, a line for each layer."""

    bought: tuple[Bought, ...]
    steps: tuple[str, ...]


class Assembling:
    """An assembly while it is told.

    plate: name of the plate that shafts run in, "" where there is none; thickness: of it, mm. base: its screws, where
    it has any. lettered: whether letters are engraved at the holes. motor: what turns the lowest wheel, under a base
    or, without one, on a plate of its own under all others.
    """

    def __init__(
        self,
        plate: str = "",
        thickness: float = 0.0,
        base: BaseStock | None = None,
        lettered: bool = False,
        motor: MotorName | None = None,
    ):
        self.plate, self.thickness, self.base, self.lettered = plate, thickness, base, lettered
        self._lines: list[tuple[str, Bill]] = []
        self._layers: dict[int, list[str]] = {}
        self._on_top: list[tuple[int, str]] = []
        self._last: list[str] = []
        self._under = 0.0
        self._face = None if motor is None else MOTORS[motor]
        # Layers of a motor's own plate.
        self._below = int(motor is not None and base is None)
        if self._face and self._below:
            held = f"screw motor_plate from above on motor {self._face.called}, its shaft up, by 4 screws"
            self._layers[0] = [held]
        if plate:
            self.tell(0, f"lay {plate}{' on the heads of its screws' if self._below else ''}")

    @property
    def lowest(self) -> int:
        """The layer of the lowest wheel, over the plate where there is one."""
        return int(bool(self.plate))

    def tell(self, layer: int, words: str) -> None:
        """Add to what is done in a layer, 0 that of the plate or, without one, the lowest."""
        self._layers.setdefault(layer + self._below, []).append(words)

    def end(self, words: str) -> None:
        """Add to what is done or left at last."""
        self._last.append(words)

    def mark(self, letter: str, part: str) -> str:
        """What the bill calls a joint: the letter at its holes or, where none is engraved, a part's name."""
        return letter if self.lettered else part

    def buy(self, mark: str, bill: Bill) -> None:
        """Add what a joint takes."""
        self._lines.append((mark, bill))

    def shaft(
        self, letter: str, part: str, stock: AbstractBored, grip: float, top: int, gap: float = 0.0, keys: int = 1
    ) -> None:
        """The shaft of a wheel, through plates and gaps of a height together, mm, and a collar at either end.

        It goes in with the plate, its upper collar on last in the layer `top`. gap: between plate and wheel, mm, kept
        by a tube. keys: how many discs have one. A motor holds its shaft itself.
        """
        mark, named = self.mark(letter, part), letter if self.lettered else f"the shaft of {part}"
        if stock.motor is not None:
            self.buy(mark, shaft_bill(stock, grip, base=0.0 if self._below else self.thickness, keys=keys))
            if not self._below:
                self.tell(0, fixed_under(self.plate, letter))
            return
        if not stock.bore:
            return
        wide = collar_width(stock.bore)
        self.buy(mark, shaft_bill(stock, grip + 2 * wide, keys=keys))
        self.buy(mark, collar_bill(stock.bore, 2))
        if self.plate:
            self.tell(0, f"put {named} through from above; a collar on {named} from below")
            self.room(wide)
        if gap:
            self.buy(mark, tube_bill(stock.bore, gap))
            self.tell(1, f"a tube of {gap:g} mm on {named}")
        self._on_top.append((top, f"a collar on {named}" if self.plate else f"a collar on {named} at either end"))

    def room(self, height: float) -> None:
        """Keep so much free under the plate, mm."""
        self._under = max(self._under, height)

    def pins(self, letter: str, part: str, diameter: float, grip: float, count: int = 1, under: bool = False) -> None:
        """Pins glued into a part that they move with, and a collar on the other end of each.

        grip: thickness of all plates on them, mm. under: the collars are under the base.
        """
        if diameter:
            mark = self.mark(letter, part)
            self.buy(mark, pin_bill(diameter, grip + collar_width(diameter), count))
            self.buy(mark, collar_bill(diameter, count))
            if under:
                self.room(collar_width(diameter))

    def planet_shafts(self, mark: str, stock: AbstractBored, grip: float, count: int, collars: bool) -> None:
        """The shafts of planets, with their keys, and a collar on each where it turns in its carrier."""
        self.buy(mark, shaft_bill(stock, grip + collars * collar_width(stock.bore), count))
        if collars:
            self.buy(mark, collar_bill(stock.bore, count))

    def screws(self, letter: str, diameter: float, grip: float, count: int) -> None:
        """Screws with their nuts, which are under the plate, through a thickness, mm."""
        if diameter in SIZES:
            held = Fastener(diameter, "screw", 0.0)
            each = held.bill(grip)
            self.room(held.ends(grip)[1])
        else:
            each = ((f"screw {diameter:g} mm with nut, at least {grip + 2 * diameter:g} mm long", 1),)
            self.room(2 * diameter)
        self.buy(letter, tuple((name, number * count) for name, number in each))

    def told(self, feet: int = 4) -> Assembly:
        """The assembly, the plate's own screws and feet at last."""
        if self._face and not self._below:
            self._stand_over(self._face, self._under + FREE, feet)
        elif self.plate and self._under:
            free = self._under + FREE
            if self.base is not None and self.base.screw:
                self.buy(self.plate, screw_bill(self.base, self.thickness + free, feet))
                self.buy(self.plate, tube_bill(self.base.screw, free, feet))
                ends = f"screw {self.plate} down by its corners, a tube of {free:g} mm under each"
                self._last.insert(0, f"{ends}, so that nothing rubs under it")
            else:
                self._last.insert(0, f"keep {free:g} mm free under {self.plate}")
        for layer, words in self._on_top:
            self.tell(layer, words)
        layers = (f"layer {layer}: {'; '.join(self._layers[layer])}" for layer in sorted(self._layers))
        return Assembly(gathered(self._lines), (*layers, *self._last))

    def _stand_over(self, motor: Motor, free: float, feet: int) -> None:
        """Feet over a motor, which is made in several lengths; free: needed by what else is under the base, mm."""
        under = f"as motor {motor.called} is long, and at least {free:g} mm"
        if self.base is None or not self.base.screw:
            self._last.insert(0, f"keep as much free under {self.plate} {under}")
            return
        screw = self.base.screw
        self.buy(self.plate, ((f"screw {screw:g} mm, at least {self.thickness:g} mm longer than its tube", feet),))
        longer = f"{FREE:g} mm longer than the motor, and at least {free:g} mm"
        self.buy(self.plate, ((f"tube {screw:g} mm inside, cut {longer}", feet),))
        ends = f"screw {self.plate} down by its corners, a tube of the motor's length and {FREE:g} mm under each"
        self._last.insert(0, f"{ends}, at least {free:g} mm")


def seated(part: str, letter: str, stock: AbstractBored) -> str:
    """How a wheel or cam is put on its shaft; letter: "" where none is engraved."""
    on = letter or ("its motor's shaft" if stock.motor else "its shaft")
    how, (width, _) = ("press" if stock.fit == "press" else "lay"), stock.keyway
    if not stock.bore:
        return f"lay {part}"
    if stock.across_flat is not None:
        return f"{how} {part} on {on}, flat on flat"
    if width:
        return f"{how} {part} on {on} with its key, for which the shaft has a keyway {width:g} mm wide"
    return f"{how} {part} on {on}" if stock.fit == "press" else f"lay {part} on {on}, where it turns unless it is glued"
