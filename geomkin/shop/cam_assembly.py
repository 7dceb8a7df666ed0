"""How a cam and its follower go together: what is bought for them, and the steps, from the bottom up."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arguments import checked
from ..cam.cam import Cam
from ..cam.followers.plates import Plate
from ..part import Bought
from .assembling import Assembling, Assembly, seated
from .base import BaseStock
from .cam import CamStock
from .cam_base import LETTERS
from .shafts import pin_bill


@checked
def cam_bought(cam: Cam, stock: CamStock = CamStock(), base: BaseStock | None = None) -> tuple[Bought, ...]:
    """The cam's shaft and key, the pins of its follower, the collars that hold them, and the base's screws and feet.

    For joints by the letters at their holes over a base, and by the names of parts without one. A shaft or pin is as
    long as all plates, gaps and collars on it. Bearings are not told. Derived here.
    """
    return cam_assembly(cam, stock, base).bought


def cam_assembly(cam: Cam, stock: CamStock, base: BaseStock | None) -> Assembly:
    """What is bought for a cam and its follower, and how all of it goes together."""
    follower, thick = cam.follower, stock.thickness
    guided = follower.plates if base is None else follower.guided_plates
    plates = guided(stock.bars, cam.program, cam.base_radius, cam.sense)
    carrying = [plate for plate in plates if plate.name != "roller"]
    # A roller runs in the plane of the cam, and what carries it lies under both; a face lies beside the cam.
    beside = bool(carrying) and follower.knife_edge is not None
    told = Assembling("" if base is None else "base", thick, base, base is not None, stock.motor)
    layer = told.lowest + beside
    gap = thick if base is not None and beside else 0.0
    told.shaft("A", "cam", stock, (0.0 if base is None else thick) + gap + thick, layer, gap)
    for plate in carrying:
        for words in _carried(told, plate, plates, stock, base):
            told.tell(told.lowest, words)
    if any(plate.name == "roller" for plate in plates):
        _roller(told, plates, stock, layer)
    # A tube keeps a shaft's cam over the follower; a motor's is held by the shaft.
    over = f", {gap:g} mm above base" if gap and stock.motor else ""
    told.tell(layer, seated("cam", "A" if told.lettered else "", stock) + f"{over}, as it is drawn and not turned over")
    if stock.timing_mark:
        told.tell(layer, "its line is under the follower at cam angle 0, and its arrow the way it turns")
    told.end(f"a spring or a weight of yours holds {plates[0].name if plates else 'the follower'} to cam")
    if base is None:
        told.end(_left(cam, bool(carrying), stock))
    return told.told()


def _carried(
    told: Assembling, plate: Plate, plates: tuple[Plate, ...], stock: CamStock, base: BaseStock | None
) -> Iterator[str]:
    """The follower or arm: its own pins glued in, flush where cam or base pass."""
    held = [hole for hole in plate.holes if hole.key == "pivot_bore" and hole.diameter]
    count, swings = len(held), plate.name == "arm"
    letter = LETTERS["pivot_bore"]
    if held and base is not None:
        pins = f"{count} pins {letter}" if count > 1 else f"pin {letter}"
        told.pins(letter, plate.name, stock.pivot_bore, 2 * stock.thickness, count, under=True)
        yield f"glue {pins} into {plate.name}, flush above"
    elif held:
        told.buy(plate.name, pin_bill(stock.pivot_bore, stock.thickness, count))
    carried = any(hole.key == "roller_bore" and hole.diameter for hole in plate.holes)
    if carried and any(other.name == "roller" for other in plates):
        named = LETTERS["roller_bore"] if told.lettered else "of roller"
        yield f"glue the pin {named} into {plate.name}, flush below"
    if base is None:
        yield f"lay {plate.name}" + (", its pin through it into what is to hold it" if held else "")
    elif swings:
        yield f"lay arm, its pin {letter} through base; a collar on {letter} from below, with room to turn"
    else:
        collars = f"{count} collars on {letter} from below, with room to slide"
        yield f"lay {plate.name}, its pins through the slot {letter} of base; {collars}"


def _roller(told: Assembling, plates: tuple[Plate, ...], stock: CamStock, layer: int) -> None:
    """The roller on its pin, over what carries it."""
    on = sum(any(hole.key == "roller_bore" for hole in plate.holes) for plate in plates)
    if not stock.roller_bore:
        told.tell(layer, "lay roller")
        return
    letter = LETTERS["roller_bore"]
    named = letter if told.lettered else "its pin"
    told.pins(letter, "roller", stock.roller_bore, on * stock.thickness)
    told.tell(layer, f"lay roller on {named}, where it turns freely; a collar on {named}, with room to turn")


def _left(cam: Cam, carried: bool, stock: CamStock) -> str:
    """What no plate holds where there is no base."""
    follower = cam.follower
    if follower.oscillates:
        away = abs(complex(np.ravel(follower.place(np.zeros(1), cam.base_radius).origin)[0]))
        return f"hold the pivot {away:.6g} mm from the shaft of cam: no plate here does"
    stem = "follower" if carried else "a stem with the pin of the roller" if follower.rounding else "a stem"
    shaft = "" if stock.motor else ", and hold the shaft of cam"
    return f"guide {stem}{shaft}: no plate here does"
