"""Effective components of the pins' velocities and accelerations, in recipes of linkages."""

from __future__ import annotations

from collections.abc import Iterator

from ...core.records import record
from ...model.check import Check
from ...model.scene import Plot, Scene
from ...model.table import Table
from ..instant.components import component_plots, components_check
from ..scene import with_components
from .aspects import AbstractLinkageAspect


@record(eq=False)
class ComponentsAspect(AbstractLinkageAspect[bool]):
    """The components of each pin's velocity and acceleration along and across its link, columns of either mode."""

    key = "effective_components"

    def plots(self, table: Table) -> Iterator[Plot]:
        return component_plots(self.mechanism.motion)

    def on_scene(self, scene: Scene) -> Scene:
        return with_components(scene, self.mechanism.motion)

    @property
    def checks(self) -> Iterator[Check]:
        yield components_check(self.mechanism.motion)
