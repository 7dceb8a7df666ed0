"""Planar linkages: sizes, closed-form motion, measures. Knows nothing of plates, pins or files."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .body_motion import Body as Body
    from .body_motion import PointMotion as PointMotion
    from .body_motion import SlideMotion as SlideMotion
    from .cognate_linkages import Cognate as Cognate
    from .cognate_linkages import cognates as cognates
    from .cognate_linkages import roberts_linkage as roberts_linkage
    from .cognate_linkages import third_pivot as third_pivot
    from .coupler_curve import coupler_curves as coupler_curves
    from .coupler_curve import coupler_grid as coupler_grid
    from .coupler_curve import dashes as dashes
    from .dwell import OutputDwell as OutputDwell
    from .dwell import longest_dwell as longest_dwell
    from .instant.centres import InstantCentre as InstantCentre
    from .instant.centres import instant_centre as instant_centre
    from .instant.centres import instant_centres as instant_centres
    from .instant.centrodes import CentrodeCurve as CentrodeCurve
    from .instant.centrodes import Centrodes as Centrodes
    from .instant.curvature import PathCurvature as PathCurvature
    from .instant.curvature import crank_path as crank_path
    from .instant.curvature import euler_savary as euler_savary
    from .instant.curvature import path_curvature as path_curvature
    from .instant.equivalent import DirectContact as DirectContact
    from .instant.inflection import Bobillier as Bobillier
    from .instant.inflection import InflectionCircle as InflectionCircle
    from .instant.inflection import bobillier as bobillier
    from .instant.inflection import bobillier_path as bobillier_path
    from .instant.inflection import inflection_circle as inflection_circle
    from .instant.inflection import inflection_circle_of_cranks as inflection_circle_of_cranks
    from .instant.polygons import VectorPolygon as VectorPolygon
    from .instant.polygons import acceleration_polygon as acceleration_polygon
    from .instant.polygons import velocity_polygon as velocity_polygon
    from .linkage import AbstractLinkage as AbstractLinkage
    from .measures import Grashof as Grashof
    from .measures import circuits as circuits
    from .measures import dead_centres as dead_centres
    from .measures import grashof as grashof
    from .measures import grashof_type as grashof_type
    from .motion import Motion as Motion
    from .motion import mechanical_advantage as mechanical_advantage
    from .motion import motion_table as motion_table
    from .openings import Opening as Opening
    from .openings import opening as opening
    from .sampled import SampledRates as SampledRates
    from .sampled import central_difference as central_difference
    from .sampled import mid_ordinate_integral as mid_ordinate_integral
    from .sampled import velocity_difference as velocity_difference
    from .shaking import Counterbalance as Counterbalance
    from .shaking import SliderCrankMasses as SliderCrankMasses
    from .shaking import best_counterbalance as best_counterbalance
    from .shaking import judged_counterbalance as judged_counterbalance
    from .shaking import shaking_force as shaking_force
    from .solve.continuation import Root as Root
    from .solve.continuation import newton_raphson as newton_raphson
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
