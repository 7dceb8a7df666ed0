"""Prints the published crank-rockers beside those found: python -m tests.speed.synthesis_rockers. Never pass or fail."""

import time

import numpy as np

import geomkin as gk

# Swing and crank's turn, deg, and the published lengths, ground 1, with their least transmission angle.
PUBLISHED = {
    (40, 160): ((0.25683, 0.51964, 0.78517), 31.854),
    (60, 170): ((0.30745, 0.75306, 0.62647), 37.371),
    (50, 200): ((0.37011, 0.87082, 0.93374), 40.671),
}
TURN = np.linspace(0, 2 * np.pi, 3601)


def moved(linkage):
    """Swing, deg, and least transmission angle, deg, of the simulated turn."""
    motion = gk.move(linkage, TURN)
    swing = np.ptp(np.unwrap(np.angle(motion.rocker.direction)))
    return np.degrees(swing), np.degrees(motion.transmission_angle.min())


def timed(call, *given, **named):
    start = time.process_time()
    found = call(*given, **named)
    return found, 1000 * (time.process_time() - start)


def figures():
    gk.crank_rocker(40, 160)
    print("crank-rockers          crank    coupler  rocker   least angle, deg; simulated swing, angle     CPU ms")
    for (swing, turn), (lengths, angle) in PUBLISHED.items():
        found, cost = timed(gk.crank_rocker, swing, turn)
        ours = found.linkage.crank, found.linkage.coupler, found.linkage.rocker
        table = moved(gk.FourBar(1, *lengths))
        print(f"{swing}/{turn}  published     {lengths[0]:.5f}  {lengths[1]:.5f}  {lengths[2]:.5f}", end="  ")
        print(f"{angle:9.3f}            {table[0]:10.5f}{table[1]:12.6f}")
        reported = moved(found.linkage)
        print(f"        ours          {ours[0]:.5f}  {ours[1]:.5f}  {ours[2]:.5f}", end="  ")
        print(f"{found.transmission_angle_deg:12.6f}         {reported[0]:10.5f}{reported[1]:12.6f}{cost:11.1f}")
    print("45/100, the trap: ", end="")
    try:
        gk.crank_rocker(45, 100)
    except gk.DesignError as error:
        print(error)
    for ratio in (4, 10, 100):
        found, cost = timed(gk.crank_rocker, 40, 180, largest_ratio=ratio)
        print(f"time ratio 1, swing 40, ratio <= {ratio}: {found.transmission_angle_deg:.6f} deg, {cost:.1f} ms")
    found, cost = timed(gk.synthesis.double_rocker, 60, 60, 80, 40)
    print(
        f"double rocker 60+60, 80+40: {found.transmission_angle_deg:.4f} deg, {found.defects or 'no'} defect, {cost:.0f} ms"
    )
    found, cost = timed(gk.synthesis.slider_crank_stroke, 100, 200)
    print(f"stroke 100, turn 200: {found.transmission_angle_deg:.4f} deg, {cost:.1f} ms")


if __name__ == "__main__":
    figures()
