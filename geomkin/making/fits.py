"""Bores of parts on shafts: running or press fit, round, with flats or with a keyway."""

from __future__ import annotations

from math import cos, pi
from typing import Any, Literal

from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, inside, quantity, rounded_down, rounded_up
from ..core.records import record
from ..model.part import HoleFit, Part
from ..plane.primitives import Circle, Polyline
from .bores import (
    PARALLEL_KEYS,
    SHARP,
    SMALLEST,
    THINNEST,
    bore,
    clearance,
    corner_radius,
    fits_of,
    flattened_bore,
    key_of,
    keyed_bore,
    many_sided_bore,
    shaft,
    widened,
)
from .materials import MaterialKey, material_entry
from .motor_faces import MountedMotorKey, face_of, motor_plate, mounted_motor_entry

# Default interference, mm: twice the error of lasers and printers, so that the hole still grips. It stretches a hole of
# 5 mm by 2 %, which wood and plastics withstand. More cracks acrylic; with less the part may slip on its shaft.
INTERFERENCE = 0.1
# Distance from the flat to the round side of motors' D-shafts, mm, by their diameter: small gear motors (3, 4 and 6),
# stepping motors (5) and larger ones (8), from makers' drawings; chosen here. For other shafts the user gives `flat`.
MOTOR_FLATS = {3.0: 2.5, 4.0: 3.5, 5.0: 4.5, 6.0: 5.5, 8.0: 7.5}
# Largest difference of the diameters of equal shafts, mm: that of a metric one given in inches with four digits.
SAME_SHAFT = 0.002
SHAFTS = ", ".join(f"{flat:g} for {shaft:g}" for shaft, flat in MOTOR_FLATS.items())
BoreForm = Literal["round", "D", "double-D", "square", "hexagonal", "keyed"]
# Number of flats of forms with flats.
FLATS: dict[str, Literal[1, 2, 4, 6]] = {"D": 1, "double-D": 2, "square": 4, "hexagonal": 6}
Fit = Literal["running", "press"]


def bore_form_entry(bore: str = "the bore") -> Any:
    """The field for the form of a bore; bore: its name in the meaning."""
    meaning = (
        f"form of {bore}: for a round shaft, a shaft with one or two flats, a square or hexagonal one, or with the "
        "keyway of DIN 6885-1"
    )
    return entry(meaning, default="round")


def flat_across() -> Any:
    """The field for the flat side of a D-shaft."""
    meaning = (
        f"of a D-shaft, from its flat side across to the round side; if omitted, a motor's: {SHAFTS}; "
        "of a shaft with two flats, a square or hexagonal one, the distance of opposite flats"
    )
    return quantity(meaning, "mm", default=None, above=0, at_most=FARTHEST)


def keyway_width(bore: str = "the bore") -> Any:
    """The field for the width of the keyway in a bore."""
    meaning = f"width of the keyway in {bore}; 0 for none or, in a keyed bore, for the standard width"
    return quantity(meaning, "mm", default=0.0, at_least=0, at_most=FARTHEST)


def keyway_depth(bore: str = "the bore") -> Any:
    """The field for the depth of the keyway in a bore."""
    meaning = f"depth of the keyway beyond {bore}, along its centre line"
    return quantity(meaning, "mm", default=0.0, at_least=0, at_most=FARTHEST)


def fit_entry(bore: str = "the bore") -> Any:
    """The field for the fit of a bore."""
    return entry(f"{bore} runs on its shaft with the clearance, or is a press fit", default="running")


def interference() -> Any:
    """The field for the interference of press fits."""
    meaning = "interference of a press-fit bore; below 0 if holes come out narrower than drawn, as on printers"
    return quantity(meaning, "mm", default=INTERFERENCE, at_least=-1, at_most=FARTHEST)


@record(checked=True)
class AbstractBored:
    """Base class of stock tables of parts on a shaft; all lengths in mm.

    Parameters
    ----------
    thickness : float, optional
        Thickness of the sheet, mm.
    bore : float, optional
        Diameter of the shaft, of a square or hexagonal one over its corners, mm; 0 for no hole.
    bore_form : {"round", "D", "double-D", "square", "hexagonal", "keyed"}, optional
        Form of the bore: for a round shaft, a motor's shaft with one or two flats, a square or hexagonal shaft, or with
        the keyway of DIN 6885-1.
    flat : float, optional
        Of a D-shaft, from its flat side across to the round side, mm; if omitted, that of the motor or of a usual one.
        Of the others, the distance of opposite flats; of a square or hexagonal one, with sharp corners if omitted.
    keyway_width, keyway_depth : float, optional
        Width of the keyway, and its depth beyond the bore along its centre line, mm. In a keyed bore 0 stands for the
        sizes of the standard, otherwise for no keyway.
    fit : {"running", "press"}, optional
        Fit of the bore.
    interference : float, optional
        Interference of a press-fit bore, mm, from -1; below 0 if holes come out narrower than drawn.
    clearance : float, optional
        How much wider a hole is than its pin or shaft, mm.
    motor : str or MotorFace, optional
        Motor that drives the part.
    material : Material, optional
        Material of the part.

    Raises
    ------
    DesignError
        If a size is out of range, or if bore, form, flat and keyway contradict each other.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the shaft", 0.0, fitted=True)
    bore_form: BoreForm = bore_form_entry()
    flat: float | None = flat_across()
    keyway_width: float = keyway_width()
    keyway_depth: float = keyway_depth()
    fit: Fit = fit_entry()
    interference: float = interference()
    clearance: float = clearance(0.0)
    motor: MountedMotorKey | None = mounted_motor_entry(
        "motor that drives the part; adds the motor's mounting plate, or its holes in a base"
    )
    material: MaterialKey | None = material_entry("the part")

    def __post_init__(self) -> None:
        self._check_bore()

    @property
    def motor_parts(self) -> tuple[Part, ...]:
        """The motor's mounting plate, about the part's axis; empty without a motor."""
        return () if self.motor is None else (motor_plate(self.motor, self.thickness, self.clearance),)

    @property
    def play(self) -> float:
        """How much wider the bore is drawn than its shaft, mm; usually negative for a press fit."""
        return self.clearance if self.fit == "running" else -self.interference

    @property
    def hole_diameter(self) -> float:
        """Diameter of a round hole in which the shaft runs, as in a base plate, mm; 0 for none."""
        return widened(self.bore, self.clearance)

    @property
    def running_fits(self) -> tuple[HoleFit, ...]:
        """The fit of such a round hole; empty for diameter 0."""
        return fits_of(self.bore, self.clearance)

    @property
    def fits(self) -> tuple[HoleFit, ...]:
        """The fit of the bore; empty for diameter 0."""
        if not self.bore:
            return ()
        flat = 0.0 if self.across_flat is None else self.across_flat + self.play
        flats = FLATS.get(self.bore_form, 1)
        return (HoleFit(self.bore, self.play, flat, self.keyway, flats=flats, is_press=self.fit == "press"),)

    @property
    def hole_reach(self) -> float:
        """Radius of the circle that contains bore and keyway, mm."""
        if self.across_flat is not None and (flats := FLATS[self.bore_form]) > 1:
            return corner_radius(self.bore, self.play, self.across_flat, flats)
        width, depth = self.keyway
        return float(abs(widened(self.bore, self.play) / 2 + depth + 0.5j * width))

    @property
    def keyway(self) -> tuple[float, float]:
        """Width of the keyway, and its depth beyond the bore, mm; 0 for none."""
        given = self.keyway_width, self.keyway_depth
        if self.bore_form != "keyed" or any(given) or not (key := key_of(self.bore)):
            return given
        return key.width, key.hub_depth

    @property
    def across_flat(self) -> float | None:
        """Distance from the flat of a D-shaft to its round side, or of opposite flats, mm; None for other shafts."""
        if self.bore_form not in FLATS:
            return None
        if self.flat is not None:
            return self.flat
        face = None if self.motor is None else face_of(self.motor)
        if face is not None and abs(face.shaft - self.bore) < SAME_SHAFT and face.bore_form == self.bore_form:
            return face.flat
        if (flats := FLATS[self.bore_form]) > 2:
            return self.bore * cos(pi / flats)
        if flats == 2:
            return None
        return next((flat for shaft, flat in MOTOR_FLATS.items() if abs(shaft - self.bore) < SAME_SHAFT), None)

    def hole(self, towards: complex, widest: float, key: str) -> tuple[Circle | Polyline, ...]:
        """The bore about the part's axis; empty for diameter 0.

        Parameters
        ----------
        towards : complex
            Unit direction of the keyway, or that the flat side faces.
        widest : float
            Least width of the part round the bore, mm.
        key : str
            Key of the stock in the recipe, for messages.
        """
        if (across := self.across_flat) is not None:
            if (flats := FLATS[self.bore_form]) > 1:
                return many_sided_bore(self.bore, self.play, across, flats, towards, widest, key)
            return flattened_bore(self.bore, self.play, across, towards, widest, key)
        if any(keyway := self.keyway):
            return keyed_bore(self.bore, self.play, *keyway, towards, widest, key)
        return bore(self.bore, self.play, widest, f"{key}.bore")

    def _check_bore(self) -> None:
        """DesignError for sizes that contradict each other, independent of the part."""
        if self.bore_form != "round" and not self.bore:
            problem = f'found 0 mm, which means no hole, and bore_form = "{self.bore_form}"'
            raise DesignError("bore", problem, 'give the shaft\'s diameter, or bore_form = "round"', "conflict")
        if self.flat is not None and self.bore_form not in FLATS:
            problem = f"found {self.flat:g} mm for a bore without a flat"
            raise DesignError("flat", problem, 'omit it, or give bore_form = "D"', "conflict")
        if self.motor is not None and self.bore >= (boss := face_of(self.motor).boss_diameter):
            problem = f"found {self.bore:g} mm on the shaft of {self.motor}, whose boss is {boss:g} mm wide"
            remedy = f"give less than {rounded_down(boss)} mm, or omit motor"
            raise DesignError("bore", problem, remedy, value=inside(boss, 1))
        if self.bore_form in FLATS:
            self._check_flat()
        if self.fit == "press":
            self._check_interference()
        if self.bore_form == "keyed" and not self.keyway_width and not self.keyway_depth and not key_of(self.bore):
            thickest = PARALLEL_KEYS[-1].thickest
            nearest = f"at least {THINNEST:g}" if self.bore < THINNEST else f"at most {thickest:g}"
            raise DesignError(
                "bore",
                f"found {self.bore:g} mm, but DIN 6885-1 has keys for shafts of {THINNEST:g} to {thickest:g} mm only",
                f'give {nearest} mm, your own keyway_width and keyway_depth, or bore_form = "D"',
                "out-of-range",
            )

    def _check_interference(self) -> None:
        """DesignError for an interference that leaves no hole at the narrowest width of the shaft."""
        narrowest = self.across_flat or self.bore
        if 0 < narrowest < self.interference + SMALLEST:
            problem = f"found {self.interference:g} mm, which leaves no hole for a shaft {narrowest:g} mm across"
            value = rounded_down(narrowest - SMALLEST) if narrowest > SMALLEST else None
            remedy = "give a thicker shaft" if value is None else f"give at most {value} mm"
            raise DesignError("interference", problem, remedy, value=value)

    def _check_flat(self) -> None:
        half, across = (self.bore / 2 if self.bore_form == "D" else 0.0), self.across_flat
        if across is None and self.bore_form == "double-D":
            remedy = f"give the distance of the flats, less than {self.bore:g} mm"
            raise DesignError("flat", 'is missing for bore_form = "double-D"', remedy, "missing-key")
        if across is None:
            shafts = ", ".join(f"{shaft:g}" for shaft in MOTOR_FLATS)
            raise DesignError(
                "bore",
                f"found {self.bore:g} mm, which is no usual diameter of a D-shaft",
                f"give one of {shafts}, or give flat, more than {half:g} and less than {self.bore:g} mm",
                "out-of-range",
            )
        if (flats := FLATS[self.bore_form]) > 2:
            half = (1 - SHARP) * self.bore * cos(pi / flats)
        if not half < across < self.bore:
            raise DesignError(
                "flat",
                f"found {across:g} mm across a shaft of {self.bore:g} mm",
                f"give more than {rounded_up(half)} and less than {rounded_down(self.bore)} mm",
                "out-of-range",
                inside(self.bore, 1),
            )
        for name, size in (("keyway_width", self.keyway_width), ("keyway_depth", self.keyway_depth)):
            if size:
                raise DesignError(
                    name, f"found {size:g} mm in a bore with a flat", 'give 0, or bore_form = "keyed"', "conflict"
                )
