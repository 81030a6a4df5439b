"""
A whole branch of orbits
========================

A scan of the amplitude shows the orbits on which a motion settles.  The branch on which they lie has unstable
orbits too.  It begins at grazing with impacts of zero speed, and goes down to the fold.  There the stable
orbits begin.  A scan can see only these.  Beyond the last event the computed orbits pass through the stop, so
that they are not admissible.
"""

# %%
# The leaf spring has one mode, and its stop is a stiff spring with a dashpot.
import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop, StroboscopicMap, simulate
from contact.orbits import Shooting, follow, settle

law = LinearContact.with_restitution(stiffness=1e7, restitution=0.3, mass=1.0)
spring = ImpactOscillator(
    model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    stop=Stop(gap=11.9e-3, law=law),
    drive=HarmonicDrive(frequency=21.5),
)

# %%
# `follow` finds a first orbit of the family by itself, and follows the branch both ways.
branch = follow(Shooting(oscillator=spring, m=4))
print(branch)

# %%
# The drive is lowered from 1 % above grazing.  At each step the motion settles, and the program keeps the
# speed of its impact.
strobed, excesses = StroboscopicMap(oscillator=spring), np.linspace(0.01, -0.01, 41)
state, seen = strobed.at(excesses[0]).steady(), []
for excess in excesses:
    here = strobed.at(excess)
    settled = settle(here, state, most_cycles=1000)
    state = settled.end
    impacts = simulate(here.oscillator, state, periods=max(settled.m, 1)).impacts
    if settled.m == 4:
        seen.append((excess, 1e3 * impacts.approach.max()))
seen = np.array(seen)
print(
    f"The scan loses the orbit below {seen[-1, 0]:.4f}; the fold is at {branch.events[0].orbit.excess:.4f}."
)

# %%
# Circles belong to the scan.
figure, axes = plt.subplots(figsize=(7.5, 4.5), layout="constrained")
branch.plot(axes)
axes.plot(*seen.T, "o", color="#D55E00", markerfacecolor="none", label="scan, amplitude lowered")
axes.axvline(0, color="0.6", linestyle="--", linewidth=1, zorder=0, label="grazing amplitude")
axes.legend(loc="lower right")
plt.show()
