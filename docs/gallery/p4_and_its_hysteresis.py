"""
p4 and its hysteresis
=====================

At 21.5 Hz the first impact of a leaf spring leads to the orbit p4, with one impact in four drive periods.
When the drive is lowered again, p4 remains below the grazing amplitude.  It ends at a fold, where it meets
an unstable orbit.  Between fold and grazing the spring has two steady motions, and its past decides
which one it follows.
"""

# %%
# The spring has one mode, and Newton's law with a restitution of 0.1 at its stop.
import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
from contact.orbits import Shooting, fold_of, orbit_diagram

spring = ImpactOscillator(
    model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    stop=Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1)),
    drive=HarmonicDrive(frequency=21.5),
)
strobed = StroboscopicMap(oscillator=spring)

# %%
# The amplitude is raised and lowered in steps of 0.04 %.  Each step starts from the last state of the step
# before.  The steps are so small that the transient of a step does not touch the stop: the last one below
# grazing is at -0.036 %.
excesses = np.linspace(-0.01956, 0.00724, 68)
record = dict(observe=strobed.tip, settle_cycles=2000, record_cycles=8)
up = orbit_diagram(strobed, excesses, strobed.at(excesses[0]).steady(), **record)
down = orbit_diagram(strobed, excesses[::-1], up.end, **record)
print("Periods while the drive is raised:  ", *np.unique(up.m))
print("Periods while the drive is lowered: ", *np.unique(down.m))

# %%
# The fold is computed without any scan: shooting finds the orbit and follows it to its end.
fold = fold_of(Shooting(oscillator=spring, m=4))
print(f"p4 ends {-100 * fold.excess:.3f} % below grazing.")

# %%
# Dots belong to the raised drive and rings to the lowered one.
figure, axes = plt.subplots(figsize=(7.5, 4.5), layout="constrained")
axes.plot(100 * down.excess, 1e3 * down.points, "o", color="#D55E00", markerfacecolor="none", markersize=6)
axes.plot(100 * up.excess, 1e3 * up.points, "o", color="#0072B2", markersize=2.5)
for place, name in ((100 * fold.excess, " fold"), (0, " grazing")):
    axes.axvline(place, color="0.4", linestyle="--", linewidth=1, zorder=0)
    axes.text(place, 2.2, name)
axes.text(-1.9, -0.8, "raised: no impact", color="#0072B2")
axes.text(-0.65, 0.3, "lowered: p4 until the fold", color="#D55E00", ha="center")
axes.text(0.7, 0.3, "p4 both ways", ha="right")
axes.set(xlabel="drive amplitude above grazing (%)", ylabel="tip displacement at each strobe (mm)")
axes.set_ylim(-4.6, 2.6)
plt.show()
