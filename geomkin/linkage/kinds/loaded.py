"""A linkage under its loads, in a recipe: the columns, plots, checks and summary of the forces that result."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...making.motors import motor_check, motor_summary, smallest_motor
from ...model.check import Check
from ...model.mass import Mass
from ...model.motor import Motor, MotorDuty, root_mean_square
from ...model.scene import Hodograph, Plot, SceneMark
from ...model.table import Column, vector_columns
from ...plane.vec import Real
from ..checks import in_driver_unit
from ..drive_limits import largest_between
from ..dynamics.inverse import ForceAnalysis
from ..linkage import Linkage
from ..motion import Motion
from ..scene import vector_marks
from .copies import Copied
from .counterweights import UNBALANCED, BalancedPlates
from .loads import LoadsTable
from .runs import LinkageRun, linkage_run

# Name of the effort with that of the copies among the peaks.
EFFORT = "effort"


@record(eq=False)
class LoadedLinkage:
    """The forces of a linkage in motion, and the torque of the shaft that it shares with its copies.

    table: the loads. masses: of the parts by body. copies_of: those on the same shaft, of a motion. given_motor: on
    that shaft, or None. on_plate: whether a plate has the holes for a motor. balanced: plates with counterweights, or
    None.
    """

    table: LoadsTable
    motion: Motion
    masses: Mapping[str, Mass]
    copies_of: Callable[[Motion], tuple[Copied, ...]]
    given_motor: Motor | None
    on_plate: bool
    balanced: BalancedPlates | None = None

    @property
    def linkage(self) -> Linkage:
        """The linkage."""
        return self.motion.linkage

    @cached_property
    def copies(self) -> tuple[Copied, ...]:
        """The copies on the same shaft."""
        return self.copies_of(self.motion)

    @cached_property
    def analysis(self) -> ForceAnalysis:
        """Driver effort and joint forces of one linkage."""
        return self.table.forces_of(self.motion, self.masses)

    @cached_property
    def effort(self) -> Real:
        """Torque of the driver, N mm, with those of the copies; the force if a slide drives, N."""
        total = self.analysis.driver
        for copy in self.copies:
            turned_over = copy.mirror is not None
            torque = self.table.forces_of(copy.motion, self.masses, turned_over).driver[copy.rows]
            total = total - torque if turned_over else total + torque
        return total

    @property
    def duty(self) -> MotorDuty:
        """Torque and speed of the shaft."""
        peak = self.peaks[EFFORT][0]
        return replace(self.analysis.duty, torque=self.effort, between=0.0 if np.isnan(peak) else peak)

    @cached_property
    def peaks(self) -> Mapping[str, tuple[float, float]]:
        """Largest driver effort, that with the copies, and largest force at each pin, also between frames, by name.

        Each with the driver there.
        """
        names = ("driver", EFFORT, *self.linkage.pins)

        def sizes(motion: Motion) -> Real:
            loaded = replace(self, motion=motion)
            forces = (
                np.fmax.reduce([np.abs(loaded.analysis.pin(pin, body)) for body in bodies[1:]])
                for pin, bodies in self.linkage.pins.items()
            )
            return np.array([np.abs(loaded.analysis.driver), np.abs(loaded.effort), *forces])

        return dict(zip(names, zip(*(array.tolist() for array in largest_between(self.motion, sizes)))))

    @cached_property
    def motor(self) -> Motor | None:
        """The given motor; without one the smallest that suffices, None if no motor can drive the linkage."""
        turns = self.linkage.driver_pivot is not None and np.isfinite(self.effort).any()
        return self.given_motor or (smallest_motor(self.duty) if turns else None)

    @cached_property
    def run(self) -> LinkageRun | None:
        """The motion that follows from a torque or the given motor; None if none is requested."""
        if self.table.run is None:
            return None
        return linkage_run(self.table.run, self.motion, self.analysis.loads, self.given_motor)

    @property
    def columns(self) -> Iterator[Column]:
        """Driver effort, joint forces, and the force and moment by which the masses shake the ground."""
        analysis, linkage = self.analysis, self.linkage
        if linkage.driven_slider is None:
            yield Column("driver_torque", "N mm", "torque of the driver, counterclockwise positive", analysis.driver)
        else:
            yield Column("driver_force", "N", "force of the driver along its line", analysis.driver)
        if self.copies:
            meaning = "torque of the shaft: that of the linkage and its copies"
            yield Column("shaft_torque", "N mm", meaning, self.effort)
        for pin, bodies in linkage.pins.items():
            for body in bodies[1:]:
                force, meaning = analysis.pin(pin, body), f"force at {pin} on {body}"
                yield from vector_columns(f"{pin}_force_on_{body}", "N", meaning, force)
        for slider in linkage.sliders:
            name, slide = slider.name, analysis.slide(slider.name)
            meaning = f"on {slider.body}, along the left normal of {name}"
            yield Column(f"{name}_normal_force", "N", f"force of {slider.along} {meaning}", slide.normal)
            yield Column(f"{name}_moment", "N mm", f"moment of {slider.along} on {slider.body}", slide.moment)
        meaning = "shaking force of the masses on the ground"
        yield from vector_columns("shaking_force", "N", meaning, analysis.shaking_force)
        at = "the driver's pivot" if linkage.driver_pivot is not None else "the origin"
        moment = f"shaking moment of the masses about {at}"
        yield Column("shaking_moment", "N mm", moment, analysis.shaking_moment)
        if self.balanced:
            yield from self.balanced.columns
        if self.run:
            yield from self.run.columns

    @property
    def plots(self) -> tuple[Plot, ...]:
        """Plots of the columns."""
        linkage = self.linkage
        effort = "torque" if linkage.driven_slider is None else "force"
        plots = [
            Plot(f"driver {effort}", (f"driver_{effort}", *(("shaft_torque",) if self.copies else ()))),
            Plot("pin forces", _pin_forces(linkage)),
            Plot("normal forces of slides", tuple(f"{slider.name}_normal_force" for slider in linkage.sliders)),
            Plot("moments of slides", tuple(f"{slider.name}_moment" for slider in linkage.sliders)),
            Plot("shaking force", ("shaking_force",)),
        ]
        runs = self.run.plots if self.run else ()
        return (*runs, *(plot for plot in plots if plot.columns))

    @property
    def hodographs(self) -> tuple[Hodograph, ...]:
        """Polar diagrams of the shaking force and of the pin forces."""
        ids = ("shaking_force", *((UNBALANCED,) if self.balanced else ()))
        shaking = Hodograph("polar diagram of the shaking force", ids)
        pins = Hodograph("polar diagram of the pin forces", _pin_forces(self.linkage))
        return (shaking, pins) if pins.columns else (shaking,)

    @property
    def marks(self) -> Iterator[SceneMark]:
        """An arrow at each pin for the force on each body but the first, all at one scale."""
        arrows = {}
        for pin, bodies in self.linkage.pins.items():
            for body in bodies[1:]:
                force = self.analysis.pin(pin, body)
                if np.isfinite(force).any():
                    arrows[f"{pin} on {body}"] = self.motion.point(pin).position, force
        yield from vector_marks(self.motion, arrows, "force", "N")

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the motor, the counterweights and the run, if there are any."""
        others: tuple[Check, ...] = (self.balanced.check(self.analysis),) if self.balanced else ()
        others += self.run.checks if self.run else ()
        if self.motor is None:
            return others
        peak, drive = self.peaks[EFFORT]
        at = None if np.isnan(peak) else in_driver_unit(self.motion, drive)
        column = "shaft_torque" if self.copies else "driver_torque"
        return (
            motor_check(self.motor, self.duty, column, at, "stock.motor" if self.on_plate else "loads.motor"),
            *others,
        )

    @property
    def summary(self) -> Mapping[str, object]:
        """Peak and rms driver effort, largest pin forces and the motor; without unknown ones."""
        analysis, slides = self.analysis, self.linkage.driven_slider is not None
        effort, unit = ("driver_force_N", "mm") if slides else ("driver_torque_N_mm", "deg")
        efforts = {effort: ("driver", analysis.driver)}
        efforts |= {"shaft_torque_N_mm": (EFFORT, self.effort)} if self.copies else {}
        result: dict[str, object] = {}
        for key, (name, values) in efforts.items():
            peak, drive = self.peaks[name]
            if np.isfinite(peak):
                nearest = np.argmin(np.abs(self.motion.drive - drive))
                result[key] = {
                    "peak": to_digits(np.copysign(peak, values[nearest])),
                    f"peak_at_{unit}": to_digits(in_driver_unit(self.motion, drive), 6),
                    "rms": to_digits(root_mean_square(values, self.motion.drive)),
                }
        result["largest_pin_force_N"] = {
            pin: to_digits(self.peaks[pin][0]) for pin in self.linkage.pins if np.isfinite(self.peaks[pin][0])
        }
        if self.motor:
            result["motor"] = motor_summary(self.motor, self.duty)
        if self.balanced:
            result |= self.balanced.summary(analysis)
        if self.run:
            result["run"] = self.run.summary
        return {**result, "undetermined": list(analysis.undetermined)}


def _pin_forces(linkage: Linkage) -> tuple[str, ...]:
    return tuple(f"{pin}_force_on_{body}" for pin, bodies in linkage.pins.items() for body in bodies[1:])
