"""Position analysis: from sizes, drive and branch to the pose of every body.

1. `plan` (moving.py) finds the order in which bodies can be placed: the driver, dyads (in closed form), then the
   remaining loops.
2. Each placement (`placement`, `dyads`, `input_dyads`, `actuators`, `loops`) computes poses and kinematic coefficients.
3. `solution` determines the branch of every dyad over the drives (`branch`) and runs the placements.
4. `move` (moving.py) adds the driver's speed and returns a Motion.

If everything is in closed form, the placements are recorded once for each structure, and its `program` is
run for all linkages of the structure, whatever their sizes.
"""
