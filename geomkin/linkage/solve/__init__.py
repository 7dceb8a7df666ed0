"""From sizes, drive and branch to where every body is, in four steps.

`plan` finds the order in which bodies can be placed: the driver, dyads (in closed form), and what is left as `loops`.
Each placement (`placement`, `dyads`, `driver_dyads`, `actuators`, `loops`) writes poses and kinematic coefficients.
`solution` picks the branch of every dyad over the drives (`branch`, `drive_range`) and runs the placements over them.
`move` makes of that a motion in time.

What moves often, or over many frames, goes without the placements' Python: a `tape` records what they do, `formulas`
names what it tells, and `worked` runs that as a `program`, by NumPy or, where there is much of it, by the loop of
`compiled`.
"""
