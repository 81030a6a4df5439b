"""
One collision
=============

An impact excites the higher modes of a spring.  The tip is fast afterwards and oscillates about the motion
of the lowest mode, which moves away much more slowly than it approached.  Restitution, time delay and kick
compare mode 1 before and after the collision.  Both motions are continued as if there were no stop.
"""

# %%
# A brass U carries a ceramic ball, 11.88 mm from a steel plate, with a Hertz stiffness of 9.6e9 N/m^1.5.
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from beam import BRASS, MeasuredDecay, StripSection, Tip, assemble, flat_u, natural_modes, reduce
from contact import HarmonicDrive, HertzContact, ImpactOscillator, Stop

section, tip = StripSection(material=BRASS, width=12e-3, thickness=1.174e-3), Tip(mass=6.83e-3)
modes = natural_modes(assemble(flat_u(leg_length=0.13, bend_radius=9e-3, section=section, tip=tip)), count=12)
model = reduce(modes, MeasuredDecay(decay_rate=3.56), 12)
stop = Stop(gap=11.88e-3, law=HertzContact(stiffness=9.6e9))
beam = ImpactOscillator(model=model, stop=stop, drive=HarmonicDrive(frequency=21.5)).with_excess(0.013)

# %%
# At 1.3 % above grazing, the steady motion comes to the plate for the first time.
from contact import before_collision, collisions, simulate

start = before_collision(beam)
hit = collisions(simulate(beam, start, periods=3), unfinished="drop")[0]
print(f"restitution {hit.restitution:.2f}, delay {1e3 * hit.delay:.2f} ms, kick {hit.kick:.2f}")

# %%
# The free motions have a stop out of reach.  For mode 1 alone, the others are reset to their steady motion.
times = hit.time + np.linspace(-0.4e-3, 0.8e-3, 1201)
free = replace(beam, stop=replace(stop, gap=0.05))
motion, incoming = (simulate(one, start, periods=2, times=times) for one in (beam, free))
after = np.searchsorted(times, hit.end)
q, v = incoming.displacement[after].copy(), incoming.velocity[after].copy()
q[0], v[0] = motion.displacement[after, 0], motion.velocity[after, 0]
alone = replace(start, displacement=q, velocity=v, time=times[after])
outgoing = simulate(free, alone, periods=1, times=times[after:])

# %%
# The delay lasts from the upward crossing by mode 1 before the collision to its downward crossing after it.
figure, axes = plt.subplots(figsize=(7.5, 4.5), layout="constrained")
blue, red = "#0072B2", "#D55E00"
for k, one, colour, line in ((0, incoming, blue, "--"), (after, outgoing, blue, "-"), (0, motion, red, "-")):
    beyond = 1e6 * (beam.tip(one.displacement) - stop.gap)
    axes.plot(1e3 * (times[k:] - hit.time), beyond, color=colour, linestyle=line)
axes.axhspan(0, 160, color="0.88", zorder=0)
axes.plot([0, 1e3 * hit.delay], [0, 0], "k|-", markersize=12)
axes.text(-0.38, 10, "plate")
axes.text(0.24, 6, "delay")
axes.text(0.53, 80, "mode 1 before, as\nwithout the plate", color=blue)
axes.text(0.54, -18, "mode 1 after", color=blue)
axes.text(0.36, -80, "tip, with all modes", color=red, ha="right")
axes.set(xlabel="time after the first touch (ms)", ylabel="tip beyond the surface (µm)", ylim=(-150, 160))
plt.show()
