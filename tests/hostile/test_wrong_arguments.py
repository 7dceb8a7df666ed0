"""Every public name, called well and then with each argument in turn replaced by what it cannot be.

What comes of it is a GeomkinError that names the argument, or a sound result: no error of Python's own from the
inside, and no warning.
"""

import contextlib
import dataclasses
import inspect
import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.arguments import argument_type
from geomkin.plane.vec import Array, Complex, Mask, Real, Whole

FOUR_BAR = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j)
CRANK = gk.SliderCrank(30, 90, 5)
DRIVE = np.linspace(0.1, 6, 9)
MOTION = gk.move(FOUR_BAR, DRIVE)
SLIDING = gk.move(CRANK, DRIVE)
CIRCLE = gk.plane.Circle(1j, 3.0)
PROGRAM = gk.Program(
    (gk.Dwell(end_deg=90), gk.Rise("cycloidal", rise=20, end_deg=180), gk.Return("harmonic", end_deg=360))
)
ROLLER = gk.TranslatingRoller(10)
CAM = gk.Cam(ROLLER, PROGRAM, 40)
PATHS = gk.linkage.crank_path(30j, 0), gk.linkage.crank_path(90 + 40j, 100)
ROD = {"ground": {"O": 0, "C": 60}, "slider": {"S": 0}, "rod": {"S": 0, "P": 70}, "arm": {"C": 0, "P": 40}}
WAY = gk.Slider("way", "slider", "ground", through=30j)
MASSES = gk.linkage.SliderCrankMasses(0.5, 0.6, 0.8)
GEAR, RING = gk.SpurGear(24, 2), gk.RingGear(60, 2)
POINTS = 3.55 + 32.6j, 2.95 + 34.4j, 2.35 + 36j, 1.75 + 37.4j, 1.2 + 38.4j, 0.75 + 39j
FLANK = gk.gear.StraightSidedGear(20, 2)
ROWS = tuple((k, round(10 - 10 * np.cos(np.radians(k)), 3)) for k in range(0, 361, 30))
CONJUGATE = gk.conjugate(GEAR.outline.piece, 24, 24.0, 40, 2.0)
LANTERN = gk.gear.LanternPinion(10, 2.0, 3.0)
PLANETARY = gk.gear.PlanetarySet(gk.SpurGear(12, 2), gk.SpurGear(24, 2), RING, 3)
TRAIN = gk.GearTrain(((12, 36), (14, 40)), 2.5)
RACK_PAIR = gk.gear.RackPair(gk.SpurGear(20, 2), gk.gear.GearRack(12, 2))
PLATE = gk.Part("plate", gk.plane.Circle(0j, 70.0), (), 3.0)
POSES = (0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4)
RISE_ENDS = {"rise": 20, "start_deg": 90, "end_deg": 180}

FOLLOWER_LOADS = gk.cam.FollowerLoads(gk.Mass(0.4), 3.0, 40.0, friction=gk.cam.GuideFriction(0.1, 50.0, 30.0))

FOUR = (0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4), (40 + 90j, 1.9)
STATE = gk.synthesis.BodyState(1 + 0j, 4.0, 10j, -10.0)

# Every public name of the geometry, the mechanisms, their checks and their parts, with what it names.
PUBLIC = {
    name: getattr(room, name)
    for room in (
        gk.plane,
        gk.linkage,
        gk.cam,
        gk.gear,
        gk.belt,
        gk.geneva,
        gk.cycloidal,
        gk.ratchet,
        gk.coupon,
        gk.synthesis,
        gk.making,
        gk.tradeoff,
        gk,
    )
    for name in dir(room)
    if not name.startswith("_")
    and not inspect.ismodule(getattr(room, name))
    and not re.search(r"\.(kinds|scene\w*)(\.|$)", getattr(getattr(room, name), "__module__", ""))
}
# Good arguments of every public name, by name.
GOOD = {
    "Arc": {"centre": 0j, "start": 2 + 0j, "sweep": 1.0},
    "BeltLoop": {"wheels": (gk.belt.LoopWheel(0j, 6.0, 20.0), gk.belt.LoopWheel(100 + 0j, 19.0, 60.0)), "pitch": 2.0},
    "CycloidalDrive": {"pins": 11, "circle": 100.0, "pin": 8.0, "eccentricity": 3.0, "discs": 2, "output_pins": 4},
    "Ratchet": {"diameter": 80.0, "teeth": 24, "pawl_length": 45.0, "undercut_deg": 15.0, "nose_radius": 0.5},
    "GenevaWheel": {"distance": 60.0, "slots": 4, "pins": 1, "roller": 6.0, "clearance": 0.2, "tip_width": 2.0},
    "LoopWheel": {"centre": 1j, "radius": 6.0, "pitches": 20.0, "is_outside": True, "outer_radius": 8.0},
    "toothed_outline": {"profile": "GT2-2M", "teeth": 20},
    "BodyState": {"velocity": 1 + 2j, "omega": 4.0, "acceleration": 10j, "alpha": -10.0, "position": 1j},
    "Cam": {"follower": ROLLER, "program": PROGRAM, "base_radius": 40.0, "direction": "clockwise"},
    "CentrodeCurve": {"linkage": FOUR_BAR, "body": "coupler", "span": (0.5, 0.7), "moving": True, "branch": 1, "start": 0.5},
    "Centrodes": {"motion": MOTION, "body": "coupler"},
    "Check": {"id": "a", "name": "a", "value": 1.0, "side": "at least", "limit": 2.0, "unit": "mm", "advice": "b"},
    "Circle": {"centre": 0j, "radius": 2.0},
    "Column": {"id": "a", "unit": "mm", "meaning": "b", "values": np.arange(3.0)},
    "DirectContact": {"point": 10 + 5j, "normal": 1j, "driver_radius": 12.0, "follower_radius": 8.0, "driver_pivot": 0j, "follower_pivot": 50 + 0j},
    "CouplerCurve": {"linkage": FOUR_BAR, "point_name": "coupler_point", "branch": 1, "span": (0.0, 6.0)},
    "Cycloid": {"radius": 10.0, "rolling": 3.0, "start": 0.1, "end": 1.0},
    "FitTest": {"pin": 3.0, "thickness": 3.0, "step": 0.1, "count": 9},
    "fit_test_parts": {"fit_test": gk.coupon.FitTest(3.0), "material": gk.making.material("acrylic")},
    "DesignError": {"field": "a", "problem": "b", "remedy": "c"},
    "Dwell": {"end_deg": 90},
    "EllipticTrammel": {"rod": 60, "rod_point": 100 + 0j, "angle_deg": 90, "driver": "rod", "origin": 0j, "ground_angle_deg": 10},
    "Expression": {"text": "log10(x)", "variable": "x"},
    "FlankGear": {"flank": FLANK.flank, "teeth": 20, "pitch_radius": 20.0},
    "Continuation": {"start": -1},
    "FollowerMotion": dict.fromkeys(("lift", "velocity", "acceleration", "jerk"), DRIVE),
    "FourBar": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": 1j, "driver": "crank", "origin": 0j, "ground_angle_deg": 0},
    "GearPair": {"first": GEAR, "second": GEAR, "centre_distance": 48.0},
    "GearRack": {"teeth": 10, "module": 2.0, "height": 5.0, "tooth_thickness_allowance": 0.0},
    "InstantCentre": {"reference": 0j, "arm": 1j, "weight": 1.0},
    "InternalGearPair": {"first": gk.SpurGear(18, 2), "second": gk.RingGear(60, 2, addendum=0.8), "centre_distance": 42.0},
    "InvertedSliderCrank": {"ground": 100, "crank": 30, "offset": 5, "line": "rocker", "point": 1j, "driver": "crank", "origin": 0j, "ground_angle_deg": 0},
    "Involute": {"base_radius": 10.0, "start": 0.1, "end": 1.0},
    "LanternPinion": {"pins": 10, "module": 2.0, "pin_diameter": 3.0},
    "LiftPolynomial": {"through": ((120, 8.0),), **RISE_ENDS},
    "LiftSpline": {"points": ROWS},
    "LiftTable": {"decimals": 3, "rows": ROWS},
    "Linkage": {"bodies": ROD, "driver": "slider", "sliders": (WAY,), "origin": 1j, "ground_angle_deg": 5.0, "estimate": {}, "slots": ()},
    "Motor": {"name": "a", "torque_n_mm": 100.0, "speed_rpm": 60.0, "lasting_torque_n_mm": 25.0, "mass_g": 50.0},
    "motor": {"name": "nema17"},
    "forward_dynamics": {"motion": gk.move(FOUR_BAR, np.linspace(0, 1, 30)), "loads": gk.Loads(masses={"coupler": gk.Mass(1.0)}), "torque": 5.0, "speed": 1.0, "duration": 0.1, "steps": 5, "start": 0.1},
    "linkage_strength_checks": {"analysis": gk.forces(MOTION, gk.Loads(masses={"coupler": gk.Mass(1.0)})), "stock": gk.linkage.LinkStock()},
    "smallest_motor": {"duty": gk.model.MotorDuty(DRIVE, DRIVE, DRIVE), "margin": 1.5},
    "Mirrored": {"curve": CIRCLE},
    "Moved": {"curve": CIRCLE, "pose": gk.plane.Pose(1j, 1j)},
    "Offset": {"curve": CIRCLE, "distance": 0.5},
    "Pantograph": {"arm": 150, "forearm": 150, "ratio": 3, "crank": 15, "crank_pivot": 65 + 0j, "origin": 0j, "ground_angle_deg": 0},
    "OldhamCoupling": {"shift": 6, "origin": 0j, "ground_angle_deg": 0},
    "OptimisedPolynomial": {"degree": 9, "match_jerk": False, "jerk_limit": None, **RISE_ENDS},
    "OptimisedSpline": {"intervals": 20, "jerk_limit": None, **RISE_ENDS},
    "OscillatingFlat": {"pivot_distance": 100, "face_offset": 5, "side": "above"},
    "OscillatingRoller": {"roller_radius": 10, "pivot_distance": 100, "arm_length": 80, "side": "below"},
    "Part": {"name": "a", "outline": CIRCLE, "holes": (CIRCLE,), "thickness": 3.0, "layer": "CUT", "count": 1, "marks": (), "body": "crank", "twist": gk.Twist(0.5), "fits": (gk.HoleFit(3.8, 0.2),)},
    "Path": {"pieces": (gk.plane.Segment(0j, 1j), gk.plane.Segment(1j, 2 + 0j))},
    "PathCurvature": {"position": 1j, "tangent": 1 + 0j, "curvature": 0.1},
    "PinionCutter": {"teeth": 24, "pressure_angle_deg": 20, "addendum": 1.25, "tip_radius": 0.2, "profile_shift": 0},
    "PlanetarySet": {"sun": gk.SpurGear(12, 2), "planet": gk.SpurGear(24, 2), "ring": RING, "planets": 3},
    "ParametricToothGear": {"teeth": 24, "module": 3.0, "x": "pi/4 - 0.4*t", "y": "t", "t_start": -1.0, "t_end": 1.0},
    "PointToothGear": {"teeth": 24, "module": 3.0, "points": POINTS},
    "Polyline": {"vertices": np.array([0, 1, 1j]), "bulges": np.array([0.0, 0.5, 0.0]), "is_closed": True},
    "Pose": {"origin": 1j, "direction": 1j},
    "Program": {"segments": PROGRAM.segments, "folder": ""},
    "RackCutter": {"pressure_angle_deg": 20, "addendum": 1, "dedendum": 1.25, "tip_radius": 0.38},
    "RackPair": {"pinion": GEAR, "rack": gk.gear.GearRack(10, 2), "distance": 24.1},
    "Return": {"law": "harmonic", "end_lift": 0, "end_deg": 360},
    "Reversed": {"curve": CIRCLE},
    "PolarArray": {"piece": gk.plane.Segment(1 + 0j, 1j), "count": 4},
    "RingGear": {"teeth": 60, "module": 2.0, "profile_shift": 0, "addendum": 1, "tooth_thickness_allowance": 0},
    "Rise": {"law": "cycloidal", **RISE_ENDS},
    "ScotchYoke": {"crank": 30, "guide": 100, "slot_deg": 90, "origin": 0j, "ground_angle_deg": 0},
    "Segment": {"start": 0j, "end": 1j},
    "Shaper": {"ground": 90, "crank": 30, "lever": 180, "link": 60, "ram_height": 85, "origin": 0j, "ground_angle_deg": -90},
    "GearMesh": {"name": "a", "first": "b", "second": "c", "teeth": (20, 30), "angle_deg": 10.0},
    "PinInSlot": {"name": "a", "body": "b", "pin": "p", "along": "c", "through": 1j, "direction_deg": 10.0},
    "Slider": {"name": "a", "body": "b", "along": "c", "point": 0j, "through": 1j, "direction_deg": 10.0, "angle_deg": 5.0},
    "SliderCrank": {"crank": 30, "coupler": 90, "offset": 5, "coupler_point": 1j, "driver": "crank", "origin": 0j, "ground_angle_deg": 0},
    "SliderCrankMasses": {"crank": 0.5, "coupler": 0.6, "slider": 0.8, "crank_centre": 0j, "coupler_centre": 30 + 0j},
    "Spline": {"points": np.array([0, 1, 1 + 1j])},
    "SpurGear": {"teeth": 24, "module": 2.0, "profile_shift": 0, "rack": gk.gear.RackCutter(), "addendum": 1.0, "tooth_thickness_allowance": 0, "tip_rounding": 0, "tip_chamfer": 0, "on_pointed_tip": "cut"},
    "StephensonSixBar": {"four_bar": FOUR_BAR, "link": 120, "output": 90, "output_pivot": 100 + 100j},
    "StraightSidedGear": {"teeth": 20, "module": 2.0, "flank_angle_deg": 25, "addendum": 1, "dedendum": 1.2},
    "Table": {"columns": (gk.Column("a", "mm", "b", DRIVE),)},
    "TranslatingFlat": {"tilt_deg": 5},
    "TranslatingRoller": {"roller_radius": 10, "offset": 5},
    "Trochoid": {"radius": 20.0, "depth": 1.0, "rounding": 0.4, "start": 0.0, "end": 1.0},
    "WattSixBar": {"four_bar": FOUR_BAR, "rocker_point": 50 - 30j, "link": 90, "output": 60, "output_pivot": 180 + 0j},
    "acceleration_polygon": {"motion": MOTION, "frame": 2, "size": 100.0, "scale": 0.1},
    "acceleration_state_four_bar": {"state": STATE, "moving": (1 + 1j, 2 + 0j)},
    "area": {"curve": CIRCLE, "accuracy": 1e-9},
    "balanced_shifts": {"first": 12, "second": 24, "total": 0.1},
    "best_counterbalance": {"linkage": CRANK, "masses": MASSES, "branch": 1, "turned": False},
    "body_guides": {"poses": POSES, "kind": "four-bar", "moving_points": (0j, 30 + 5j), "region": (-50 - 50j, 150 + 150j), "trammel_driver": "rod", "least_transmission_angle_deg": 5.0, "largest_ratio": 90.0, "seed": 1, "time_limit": 5.0, "driving_point": "either"},
    "rectification": {"poses": POSES, "driven": 30 + 10j, "reach": 50.0},
    "bobillier": {"one": PATHS[0], "two": PATHS[1]},
    "bobillier_path": {"one": PATHS[0], "tangent_foot": 1j, "tangent": 1 + 1j, "position": 5 + 0j},
    "burmester_curves": {"poses": FOUR, "reach": 200.0},
    "centroid": {"curve": CIRCLE, "accuracy": 1e-9},
    "central_difference": {"samples": np.cos(DRIVE), "interval": 0.1, "derivative": 2, "order": 4, "periodic": False, "inexact": 1e-6},
    "chebyshev_points": {"span": (1.0, 3.0), "count": 3},
    "chord": {"gear": GEAR, "radius": 24.0},
    "circle_of_sliders": {"poses": FOUR[:3]},
    "circuits": {"linkage": FOUR_BAR, "motion": MOTION},
    "cognates": {"four_bar": FOUR_BAR},
    "HoleFit": {"diameter": 8.0, "play": -0.1, "flat": 0.0, "keyway": (0.0, 0.0), "travel": 5.0},
    "Helix": {"helix_angle_deg": 20.0, "hand": "left", "herringbone": True},
    "Twist": {"turn": 0.5, "shift": 0.0, "herringbone": False, "moves": "outline"},
    "conjugate": {"tooth": GEAR.outline.piece, "teeth": 24, "pitch_radius": 24.0, "mate_teeth": 40, "addendum": 2.0, "internal": False},
    "contact_travel": {"cam": gk.Cam(gk.TranslatingFlat(), PROGRAM, 60)},
    "convexity": {"curve": CIRCLE, "t": DRIVE},
    "coupler_curves": {"motion": MOTION, "points": np.array([1j, 2.0]), "body": "coupler"},
    "coupler_grid": {"length": 10.0, "height": 5.0, "rows": 2, "columns": 3, "centre": 1j},
    "crank_rocker": {"swing_deg": 40, "crank_turn_deg": 160, "ground": None, "sense": "same", "crank": 30.0, "coupler": None, "rocker": None, "free_angle_deg": 20, "largest_ratio": 50},
    "crank_path": {"pin": 1j, "pivot": 0j},
    "curvature": {"curve": CIRCLE, "t": DRIVE},
    "dashes": {"linkage": FOUR_BAR, "points": np.array([1j]), "drive": DRIVE, "tolerance": 0.1, "branch": 1, "body": "coupler"},
    "dead_centres": {"linkage": FOUR_BAR, "output": "rocker", "branch": 1, "span": (0.0, 6.0)},
    "double_rocker": {"crank_start_deg": 60, "crank_swing_deg": 60, "rocker_start_deg": 80, "rocker_swing_deg": 40, "ground": 100.0, "crank": 40, "rocker": None, "free_angle_deg": None, "largest_ratio": 50},
    "grashof": {"linkage": FOUR_BAR},
    "longest_dwell": {"motion": MOTION, "output": "rocker", "band": 0.1},
    "straight_part": {"motion": MOTION, "point": "coupler_point", "start": 0.5, "end": 2.0},
    "scaled": {"thing": FOUR_BAR, "scale": 2.0},
    "driver_limits": {"linkage": FOUR_BAR, "branch": 1, "span": (0.0, 6.0)},
    "dyads_through": {"poses": FOUR, "count": 20},
    "effective_components": {"motion": MOTION},
    "euler_savary": {"instant_centre": 0.0, "point": 3.0, "centre": -2.0},
    "flatten": {"curve": CIRCLE, "tolerance": 0.01},
    "function_generator": {"function": "log10(x)", "span": (1.0, 2.0), "input_deg": 60.0, "output_deg": 90.0, "input_start_deg": 90.0, "output_start_deg": -20.0, "least_transmission_angle_deg": 30.0, "largest_ratio": 10.0, "method": "minimax", "points": 3, "ground": 100.0},
    "grashof_type": {"linkage": FOUR_BAR},
    "image_poles": {"poses": FOUR, "reference": 1},
    "inflection_circle": {"motion": MOTION, "body": "coupler"},
    "inflection_circle_of_cranks": {"one": PATHS[0], "two": PATHS[1]},
    "instant_centre": {"motion": MOTION, "body": "coupler", "other": "ground"},
    "instant_centres": {"motion": MOTION},
    "judged_counterbalance": {"linkage": CRANK, "masses": MASSES, "product": 3 + 1j, "branch": 1},
    "least_base_circle": {"follower": ROLLER, "program": PROGRAM, "direction": "clockwise", "pressure_angle_deg": 30.0, "least_radius": 1.0},
    "length": {"curve": CIRCLE, "accuracy": 1e-9},
    "mechanical_advantage": {"motion": MOTION, "output": "rocker"},
    "move": {"linkage": FOUR_BAR, "drive": DRIVE, "branch": 1, "speed": 10.0, "acceleration": DRIVE},
    "named_function": {"name": "power", "coefficients": [2.0, 1.5]},
    "nearest": {"curve": CIRCLE, "points": np.array([5j, 2.0])},
    "nearest_linkages": {"points": POINTS, "bars": 4, "count": 2},
    "newton_raphson": {"f": lambda x: 3 * x - 6, "jacobian": lambda x: np.diag(np.full(len(x), 3.0)), "estimate": 1.0, "tolerance": 1e-12, "steps": 20},
    "over_pins": {"gear": GEAR, "pin": 3.5},
    "path_generator": {"points": POINTS, "drive_deg": (0.0, 20.0, 40.0, 60.0, 80.0, 100.0), "closed": False, "least_transmission_angle_deg": 20.0, "largest_ratio": 10.0, "bounds": {"crank": (1.0, 50.0)}, "seed": 0, "time_limit": 10.0, "slides": False, "bars": 4, "geared": False, "effort": 1, "weights": (1.0, 1.0, 5.0, 5.0, 1.0, 1.0)},
    "path_curvature": {"motion": MOTION, "body": "coupler", "local": 40 + 25j},
    "poles": {"poses": FOUR},
    "polar_radius": {"outline": CIRCLE, "angle": DRIVE},
    "pressure_angle": {"cam": CAM, "angle": DRIVE},
    "roberts_linkage": {"four_bar": FOUR_BAR, "start": 0.5, "branch": 1},
    "rounded_hull": {"centres": np.array([0, 10, 5j]), "radius": 2.0},
    "segment_limits": {"cam": CAM},
    "shaking_force": {"motion": SLIDING, "masses": MASSES, "counterbalance": 3.0 + 0j},
    "signed_area": {"curve": CIRCLE, "accuracy": 1e-9},
    "slider_function_generator": {"function": "log10(x)", "span": (1.0, 2.0), "input_deg": 60.0, "output_mm": 50.0, "input_start_deg": None, "output_start_mm": None, "least_transmission_angle_deg": 30.0, "largest_ratio": 10.0, "method": "minimax", "points": 3},
    "slot": {"start": 0j, "end": 10 + 0j, "radius": 2.0},
    "span": {"gear": GEAR, "teeth": 3},
    "third_pivot": {"four_bar": FOUR_BAR},
    "to_arcs": {"curve": CIRCLE, "tolerance": 0.01},
    "undercut": {"cam": CAM},
    "undercut_free_shift": {"teeth": 12, "rack": gk.gear.RackCutter()},
    "velocity_state_four_bar": {"state": STATE, "speeds": (2.0, -3.0), "fixed": (1 + 1j, 2 + 0j)},
    "velocity_polygon": {"motion": MOTION, "frame": 2, "size": 100.0, "scale": 0.1},
    "least_transmission_angle": {"motion": MOTION},
    "show": {"thing": FOUR_BAR},
    "edit": {"recipe": {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}},
    "slider_crank_stroke": {"stroke": 80.0, "crank_turn_deg": 190, "offset": None, "crank": 38.0, "coupler": None, "free_angle_deg": None, "largest_ratio": 50},
    "assembly_failure": {"motion": MOTION},
    "BaseStock": {"screw": 4.0, "edge": 6.0, "clearance": 0.2},
    "RackBaseStock": {"screw": 4.0, "edge": 6.0, "clearance": 0.2, "guide_pin": 4.0},
    "CamStock": {"thickness": 5.0, "bore": 8.0, "bore_form": "keyed", "fit": "press", "interference": 0.1, "motor": "nema17", "keyway_width": 2.0, "keyway_depth": 1.0, "timing_mark": True, "clearance": 0.1},
    "MotorFace": {"product": "a", "face_width": 42.3, "screws": (15+15j, -15-15j), "boss_diameter": 22.0, "boss_height": 2.0, "shaft": 5.0, "flat": 4.5, "thread": 3.0, "least_depth": 2.0, "largest_depth": 4.5, "nuts": True, "face_offset": 0.0, "flats": 2},
    "GearStock": {"thickness": 6.0, "bore": 8.0, "bore_form": "D", "flat": 7.0, "fit": "press", "interference": 0.1, "motor": "nema17", "clearance": 0.1, "web": gk.gear.Web(16, 5)},
    "LanternStock": {"thickness": 6.0, "bore": 8.0, "bore_form": "D", "flat": 7.0, "mate_bore": 8.0, "mate_bore_form": "D", "mate_flat": 7.0, "mate_fit": "press", "interference": 0.1, "motor": "nema17", "clearance": 0.1, "edge": 4.0, "rim": 8.0},
    "Attachment": {"name": "hub", "holes": (10j,), "bolts": 4, "bolt_circle": 16.0, "bore": 5.0, "angle_deg": 0.0, "screw": 3.0, "thickness": 3.0, "set_screw": False},
    "LinkAttachment": {"name": "arm", "body": "rocker", "at": 70 + 0j, "mass_kg": 0.1},
    "LinkStock": {"thickness": 3.0, "bar_width": 14.0, "pin_diameter": 4.0, "clearance": 0.2, "motor": "nema17", "fit": "press", "interference": 0.1},
    "PairStock": {"thickness": 6.0, "bore": 8.0, "fit": "press", "mate_bore": 8.0, "mate_bore_form": "keyed", "mate_keyway_width": 2.0, "mate_keyway_depth": 1.0, "clearance": 0.0, "rim": 8.0},
    "PlateStock": {"thickness": 3.0, "margin": 8.0, "pin_diameter": 4.0},
    "RingStock": {"thickness": 6.0, "rim": 8.0},
    "Web": {"hub": 16.0, "rim": 5.0, "form": "holes", "count": 5, "spoke_width": 4.0},
    "base_plate": {"name": "a", "axes": [0j, 40 + 0j], "holes": [5.0, 6.0], "margin": 5.0, "thickness": 3.0},
    "cam_checks": {"cam": CAM, "cut": None},
    "cam_parts": {"cam": CAM, "stock": gk.cam.CamStock(), "cut": None, "base": gk.making.BaseStock()},
    "carrier": {"gears": PLANETARY, "diameters": (6.0, 5.0), "margin": 5.0, "thickness": 3.0},
    "collision_check": {"collisions": 2, "advice": "a"},
    "conjugate_checks": {"mate": CONJUGATE, "module": 2.0, "pieces": 1, "longer": "a"},
    "engraved": {"name": "a", "marks": [CIRCLE], "stock": gk.linkage.PlateStock()},
    "gear_checks": {"gear": GEAR, "rim": 8.0, "name": "a"},
    "gear_parts": {"gear": GEAR, "stock": gk.gear.GearStock(), "name": "a", "key": "b", "count": 2, "helix": gk.gear.Helix(20)},
    "hole_check": {"hole_diameter": 4.0, "thickness": 3.0},
    "lantern_parts": {"pinion": LANTERN, "mate": CONJUGATE, "stock": gk.gear.LanternStock()},
    "link_parts": {"motion": MOTION, "stock": gk.linkage.LinkStock(), "stack": None},
    "linkage_checks": {"motion": MOTION},
    "mesh_checks": {"pair": gk.GearPair(GEAR, GEAR), "name": "a"},
    "motor_plate": {"motor": "nema17", "thickness": 5.0, "clearance": 0.1},
    "pair_parts": {"gear": GEAR, "mate": CONJUGATE, "stock": gk.gear.PairStock()},
    "pair_base": {"distance": 40.0, "reaches": (20.0, 24.0), "shafts": (5.0, 6.0), "thickness": 3.0, "stock": gk.making.BaseStock(), "keys": ("a", "b"), "motor": "nema17"},
    "planetary_base": {"gears": PLANETARY, "ring": PLATE, "rim": 8.0, "shaft": 6.0, "stock": gk.making.BaseStock(), "motor": "nema17"},
    "rack_base": {"pair": RACK_PAIR, "rack": PLATE, "shaft": 6.0, "stock": gk.making.RackBaseStock(), "motor": "nema17"},
    "planetary_checks": {"gears": PLANETARY},
    "stack_links": {"motion": MOTION, "stock": gk.linkage.LinkStock()},
    "touch_check": {"mate": CONJUGATE, "module": 2.0},
    "tolerances": {"motion": MOTION, "of": "coupler_point", "lengths": 0.1, "clearances": {"crank_pin": 0.05}},
    "sweep": {"recipe": {"kind": "spur-gear", "gear": {"teeth": 12, "module": 2}}, "values": {"gear.teeth": "12"}, "results": (), "executor": None},
    "svg_path_points": {"path": "M 0 0 L 10 5 C 20 0 30 10 40 0", "count": 12},
    "xy": {"z": np.array([1j, 2.0])},
    "mid_ordinate_integral": {"rates": np.cos(DRIVE), "interval": 0.1, "start": 2.0, "inexact": 1e-6},
    "velocity_difference": {"samples": np.cos(DRIVE), "interval": 0.1, "inexact": 1e-6},
    "Method": {"name": "a", "about": "b", "make": lambda problem, setting: list, "setting": "step", "settings": (1.0, 0.5), "rationale": "", "caveat": "", "slow": False},
    "pareto_front": {"seconds": np.array([1.0, 2.0]), "errors": np.array([2.0, 1.0])},
    "Force": {"body": "coupler", "point": 10 + 0j, "force": 5j, "frame": "body"},
    "GasSpring": {"body": "rocker", "point": 10 + 0j, "to_body": "ground", "to_point": 5j, "force": 100.0, "extended": 200.0, "stroke": 80.0},
    "Loads": {"gravity": -9.81j, "masses": {"crank": gk.Mass(0.5)}, "forces": (gk.Force("coupler", 1j, 5j),)},
    "Mass": {"mass": 0.5, "centre": 10 + 0j, "inertia": 2e-4},
    "Material": {"name": "a", "density": 1200.0, "modulus": 3.2, "poisson_ratio": 0.35, "strength": 70.0},
    "PinFriction": {"pin": "crank_pin", "coefficient": 0.1, "radius": 4.0, "viscous": 0.0},
    "SlideForce": {"slide": "slider", "force": -200.0},
    "SlideFriction": {"slide": "slider", "coefficient": 0.1, "length": 30.0, "viscous": 0.0},
    "Spring": {"body": "rocker", "point": 10 + 0j, "to_body": "ground", "to_point": 5j, "stiffness": 2.0, "free_length": 40.0, "preload": 0.0},
    "Torque": {"body": "rocker", "torque": 2.0, "reaction_on": "ground"},
    "TorsionSpring": {"body": "rocker", "to_body": "ground", "stiffness": 2.0, "free_angle_deg": 20.0, "preload": 0.0},
    "area_moments": {"curve": CIRCLE, "accuracy": 1e-9},
    "balance": {"motion": gk.move(FOUR_BAR, DRIVE, speed=10.0), "loads": gk.Loads(gravity=-9.81j, masses={"coupler": gk.Mass(0.5)}), "bodies": ("crank", "rocker"), "objective": "shaking_force", "max_mass": 1.0, "max_radius": 40.0, "about": 0j},
    "forces": {"motion": gk.move(FOUR_BAR, DRIVE, speed=10.0), "loads": gk.Loads(gravity=-9.81j, masses={"coupler": gk.Mass(0.5)}), "about": 0j},
    "FollowerLoads": {"mass": gk.Mass(0.4), "stiffness": 3.0, "preload": 40.0, "force": -5.0, "gravity": -9810j, "friction": gk.cam.GuideFriction(0.1, 50.0, 30.0)},
    "GuideFriction": {"coefficient": 0.1, "length": 50.0, "overhang": 30.0},
    "cam_forces": {"cam": CAM, "loads": FOLLOWER_LOADS, "angle": DRIVE, "speed": 60.0, "acceleration": 100.0},
    "jump_speed": {"cam": CAM, "loads": FOLLOWER_LOADS},
    "least_preload": {"cam": CAM, "loads": FOLLOWER_LOADS, "speed": 60.0},
    "least_stiffness": {"cam": CAM, "loads": FOLLOWER_LOADS, "speed": 60.0},
    "material": {"name": "brass"},
    "optimise": {"recipe": {"kind": "spur-gear", "gear": {"teeth": 12, "module": 2}}, "vary": {"gear.teeth": (12, 13)}, "minimise": "undercut", "subject_to": (), "starts": 1, "seed": 0, "time_limit": 5.0},
    "LoadFactors": {"application_factor": 1.25, "dynamic_factor": 1.1, "face_load_factor": 1.2},
    "GearLoads": {"torque_n_mm": 2000.0, "application_factor": 1.25, "dynamic_factor": 1.1, "face_load_factor": 1.2},
    "RackLoads": {"force_n": 20.0, "application_factor": 1.25, "dynamic_factor": 1.1, "face_load_factor": 1.2},
    "RackStrength": {"pair": gk.gear.RackPair(GEAR, gk.gear.GearRack(9, GEAR.module)), "loads": gk.gear.RackLoads(force_n=20.0), "face_width": 10.0, "materials": (gk.making.material("brass"), gk.making.material("brass"))},
    "TrainLoads": {"output_torque_n_mm": 2000.0, "application_factor": 1.25, "dynamic_factor": 1.1, "face_load_factor": 1.2},
    "TrainStrength": {"train": gk.GearTrain(((12, 36),), 2.0), "loads": gk.gear.TrainLoads(output_torque_n_mm=2000.0), "face_width": 10.0, "materials": (gk.making.material("brass"), gk.making.material("brass"))},
    "PairStrength": {"pair": gk.GearPair(GEAR, GEAR), "torque_n_mm": 2000.0, "face_width": 10.0, "materials": (gk.making.material("brass"), gk.making.material("brass"))},
    "root_section": {"gear": GEAR},
    "tooth_form": {"gear": GEAR, "radius": 25.0},
    "GearTrain": {"stages": ((12, 36), (14, 40)), "module": 2.0, "directions_deg": (0, 90), "backlash": 0.05, "friction": 0.1},
    "gear_train": {"ratio": 4.0, "module": 2.0, "least_teeth": 12, "most_teeth": 40, "most_stages": 2, "error": 0.0, "reverted": False, "centre_distance": 60.0},
    "loss_factor": {"pair": gk.GearPair(GEAR, GEAR)},
    "ArborStock": {"thickness": 6.0, "bore": 5.0, "bore_form": "D", "flat": 4.5, "fit": "press", "interference": 0.1, "clearance": 0.1, "pin": 2.0},
    "TrainStocks": {"stock": gk.gear.ArborStock(), "first": gk.gear.GearStock(bore=5.0), "last": gk.gear.GearStock(bore=5.0), "base": gk.making.BaseStock()},
    "arbor_check": {"train": TRAIN, "stocks": gk.gear.TrainStocks()},
    "train_assembly": {"train": TRAIN, "stocks": gk.gear.TrainStocks()},
    "train_parts": {"train": TRAIN, "stocks": gk.gear.TrainStocks()},
    "train_table": {"train": TRAIN},
}  # fmt: skip
# What only geomkin itself makes, bases that are not called, and what reads or writes files, tried elsewhere.
MADE = {
    "Grashof", "OutputDwell", "StraightPart", "PathCount", "AreaMoments", "CamForces", "DriveTable", "Balance", "ForceAnalysis", "ForwardMotion", "SlideForces", "MATERIALS", "ACTUATORS", "MOTOR_FACES", "MOTORS", "PROFILES", "masses",
    "RootSection", "SampledDeviations", "ToleranceAnalysis", "ToothForm", "ToothStrength", "strength_checks",
    "index", "load", "make", "verify", "write", "Stack", "PathFound",
    # Tables, which are looked at as tables.
    "motion_table", "cam_table", "tooth_table", "contact_table", "flank_table", "pin_table",
    "AbstractCurve", "AbstractFace", "AbstractFlankGear", "AbstractFollower", "AbstractGear", "AbstractInvoluteGear", "AbstractLinkage", "AbstractRoller", "AbstractShaper", "FOLLOWERS", "Hole", "FollowerPlate",
    "CrankRocker", "DoubleRocker", "Family", "Found", "StrokeCrank",
    "Burmester", "BurmesterCurve", "Dyads", "SliderCircle", "StateFourBar",
    "BaseCircle", "Bobillier", "Body", "EffectiveComponents", "Cognate", "Conjugate", "Contact", "Counterbalance", "FailedChecksError", "FileError",
    "BodyGuide", "Rectification", "GeomkinError", "InflectionCircle", "Motion", "AssemblyFailure", "PointMotion", "SampledRates", "VectorPolygon", "RecipeError", "Root", "SegmentLimits", "SlideMotion", "Undercut", "Untouched",
    "FunctionGenerator", "Peak", "SliderFunctionGenerator",
    "Chart", "FAMILIES", "FamilyChart", "Measurement", "MethodFamily", "chart", "chart_files", "Stability", "stability",
}  # fmt: skip
BAD = {
    "None": None,
    "text": "3 mm",
    "nan": float("nan"),
    "inf": float("inf"),
    "complex nan": complex(0, np.nan),
    "pair": (3, 4),
    "list": [1.0, 2.0],
    "array": np.array([20.0, 30.0]),
    "matrix": np.ones((2, 3)),
    "empty": np.array([]),
    "array of nan": np.full(9, np.nan),
    "array of texts": np.array(["a", "b"]),
    "ragged": [[1], [2, 3]],
    "table": {"a": 1},
    "true": True,
    "object": object(),
    "class": gk.FourBar,
    "curve": CIRCLE,
    "linkage": FOUR_BAR,
    "motion": MOTION,
    "zero": 0,
    "negative": -7.5,
    "huge": 1e300,
    "huge array": np.full(3, 1e300),
    "endless": 10**400,
    "complex": 3 + 4j,
}
# What nothing takes: its refusal names the argument itself.
NEVER = ("object", "array of texts", "complex nan")


def test_every_public_name_is_tried():
    assert set(GOOD) | MADE == set(PUBLIC) and not set(GOOD) & MADE


def used(result):
    """A result, after a look at all it offers: what was taken without a look may still break there."""
    if isinstance(result, gk.AbstractCurve):
        t = np.append(result.breaks, 0.5 * (result.breaks[1:] + result.breaks[:-1]))
        result.point(t), result.velocity(t), result.curvature(t)
    elif dataclasses.is_dataclass(result) and type(result).__module__.startswith("geomkin"):
        for name, member in inspect.getmembers_static(type(result)):
            if not name.startswith("_") and not inspect.isfunction(member) and name != "optima":
                getattr(result, name)
    if isinstance(
        result, gk.Dwell | gk.Rise | gk.cam.LiftPolynomial | gk.cam.OptimisedSpline | gk.cam.OptimisedPolynomial
    ):
        rise = (gk.Rise("3-4-5", rise=20, end_deg=180),) if isinstance(result, gk.Dwell) else ()
        dwell = () if isinstance(result, gk.Dwell) else (gk.Dwell(end_deg=90),)
        gk.Program((*dwell, result, *rise, gk.Return("3-4-5", end_deg=360))).motion([1.0, 2.0])
    if isinstance(result, gk.Return):
        gk.Program((gk.Rise("3-4-5", rise=20, end_deg=180), result)).motion([1.0, 2.0])
    if isinstance(result, gk.cam.LiftTable | gk.cam.LiftSpline):
        gk.Program((result,)).motion([1.0, 2.0])
    if hasattr(type(result), "linkage") and not isinstance(result, gk.linkage.DirectContact):
        with contextlib.suppress(gk.DesignError):
            gk.move(result, [0.3])
    return result


# Each of hundreds of calls that are sound enough to search takes a tenth of a second and more.
SEARCHES = {"function_generator", "slider_function_generator", "path_generator"}


QUICK = sorted(set(GOOD) - SEARCHES)


@pytest.mark.parametrize(
    "names",
    [QUICK[k::12] if k % 6 == 0 else pytest.param(QUICK[k::12], marks=pytest.mark.campaign) for k in range(12)],
    ids=lambda names: names[0],
)
def test_a_wrong_argument_is_refused_by_name_or_makes_sense(names):
    for name in names:
        try_arguments(name)


@pytest.mark.campaign
@pytest.mark.parametrize("name", sorted(SEARCHES))
def test_a_wrong_argument_of_a_search_is_refused_by_name_or_makes_sense(name):
    try_arguments(name)


def try_arguments(name):
    call, good = PUBLIC[name], GOOD[name]
    used(call(**good))
    broken = []
    for argument in good:
        for what, bad in BAD.items():
            if what == "class" and (inspect.isfunction(good[argument]) or argument == "law"):
                continue  # it can be called, and what it raises is its own
            try:
                used(call(**good | {argument: bad}))
            except gk.GeomkinError as error:
                if not str(error).isprintable() or (what in NEVER and not error.field.endswith(argument)):
                    broken.append(f"{argument} = {what}: {error}")
            except Exception as error:
                broken.append(f"{argument} = {what}: {type(error).__name__}: {error}")
    assert not broken, "\n".join([f"{name}: {len(broken)} raw errors", *broken])


def test_an_array_is_held_to_the_kind_of_number_that_it_is_declared_to_hold():
    row = {"true": np.ones(2, bool), "whole": np.ones(2, int), "real": np.ones(2), "complex": np.ones(2, complex)}
    taken = {"Array": Array, "Complex": Complex, "Real": Real, "Whole": Whole, "Mask": Mask}
    numbers = {"whole", "real", "complex"}
    assert {name: {kind for kind in row if argument_type(hint).fits(row[kind])} for name, hint in taken.items()} == {
        "Array": numbers,
        "Complex": numbers,
        "Real": {"whole", "real"},
        "Whole": {"whole"},
        "Mask": {"true"},
    }
    assert not any(argument_type(hint).fits(row["real"].tolist()) for hint in taken.values())


@pytest.mark.parametrize("path", ["a" * 300, "\x00", "\ud800", 3, None], ids=["long", "zero byte", "half", "3", "None"])
def test_a_path_that_no_file_system_has_is_refused_by_the_name_of_its_argument(path):
    gear = {"kind": "spur-gear", "gear": {"teeth": 20, "module": 2}}
    calls = {
        "folder": (gk.verify,),
        "out": (gk.index, lambda out: gk.make(gear, out)),
        "path": (lambda path: gk.write(gk.load(gear), path), gk.show(FOUR_BAR).save),
    }
    if path is not None:
        ranges = {"gear.profile_shift": (0, 0.1)}
        calls["out"] += (
            lambda out: gk.sweep(gear, {"gear.teeth": [20]}, out=out),
            lambda out: gk.optimise(gear, ranges, "max(along)", out=out),
        )
    for argument, functions in calls.items():
        for function in functions:
            with pytest.raises(gk.DesignError) as refused:
                function(path)
            assert refused.value.field == argument
    with pytest.raises(gk.GeomkinError):
        gk.load(path)


PLACES = [
    ([[0, 0], [4, 0], [4, 3]], False),
    (((0, 0), (4, 0)), False),
    (np.array([[0.0, 0], [4, 0]]), False),
    ((3.0, 4.0), False),
    ([3.0, 4.0], True),
    (np.array([3.0, 4.0]), True),
    ([[1j, 2], [3, 4]], True),
    (np.array([[0.0, 1, 2], [3, 4, 5]]), True),
]


def test_pairs_of_numbers_are_not_taken_for_points_on_the_x_axis():
    """Only a row of two numbers may be two places there; a table of pairs is x and y, which points are not given by."""
    circle = gk.plane.Circle(0j, 1.0)
    for places, fits in PLACES:
        if fits:
            assert gk.nearest(circle, places)[0].shape == np.shape(places)
            continue
        with pytest.raises(gk.DesignError) as refused:
            gk.nearest(circle, places)
        assert refused.value.field == "points"
