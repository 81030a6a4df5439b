"""
One collision
=============

An impact of a real spring excites its higher modes, and the tip leaves fast and oscillates about the
motion of the lowest mode.  That motion leaves the stop much more slowly than it came, though the contact is elastic.
Three numbers describe this: an effective restitution, a time delay and a kick.  They compare the motion of
mode 1 before the collision with the motion after it, both continued as if there were no stop.
"""

# %%
# A brass U with damping tape on its legs carries a ceramic ball.  A steel plate is 11.88 mm away, and the
# two have a Hertz contact of 9.6e9 N/m^1.5.
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from beam import BRASS, DAMPING_TAPE, Layer, MeasuredDecay, StripSection, Tip, assemble, flat_u, natural_modes, reduce
from contact import HarmonicDrive, HertzContact, ImpactOscillator, State, Stop, before_collision, collisions, simulate

bare = StripSection(material=BRASS, width=12e-3, thickness=1.176e-3)
taped = replace(bare, layer=Layer(material=DAMPING_TAPE, thickness=0.45e-3))
sizes = dict(leg_length=0.13, bend_radius=9e-3, tip=Tip(mass=6.83e-3))
modes = natural_modes(assemble(flat_u(section=bare, damped_section=taped, **sizes)), count=12)
model = reduce(modes, MeasuredDecay(decay_rate=3.56), 12)
stop = Stop(gap=11.88e-3, law=HertzContact(stiffness=9.6e9))
beam = ImpactOscillator(model=model, stop=stop, drive=HarmonicDrive(frequency=21.5)).with_excess(0.013)

# %%
# At 1.3 % above grazing, the steady motion reaches the plate for the first time.
start = before_collision(beam)
hit = collisions(simulate(beam, start, periods=3), unfinished="drop")[0]
print(f"restitution {hit.restitution:.2f}, delay {1e3 * hit.delay:.2f} ms, kick {hit.kick:.2f}")

# %%
# A stop out of reach continues a motion.  After the contact only mode 1 keeps its state; it becomes the
# motion that the lowest mode would make alone.
times = hit.time + np.linspace(-0.4e-3, 0.8e-3, 1201)
free = replace(beam, stop=replace(stop, gap=0.05))
motion, incoming = (simulate(one, start, periods=2, times=times) for one in (beam, free))
after = np.searchsorted(times, hit.end)
q, v = incoming.displacement[after].copy(), incoming.velocity[after].copy()
q[0], v[0] = motion.displacement[after, 0], motion.velocity[after, 0]
state = State(displacement=q, velocity=v, time=times[after])
outgoing = simulate(free, state, periods=1, times=times[after:])

# %%
# The delay lasts from the upward crossing of the plate by one motion to the downward crossing by the other.
figure, axes = plt.subplots(figsize=(7.5, 4.5), layout="constrained")
for first, one, colour, line in (
    (0, incoming, "#0072B2", "--"), (after, outgoing, "#0072B2", "-"), (0, motion, "#D55E00", "-")
):
    height = 1e6 * (beam.tip(one.displacement) - stop.gap)
    axes.plot(1e3 * (times[first:] - hit.time), height, color=colour, linestyle=line)
axes.axhspan(0, 160, color="0.88", zorder=0)
axes.plot([0, 1e3 * hit.delay], [0, 0], "k|-", markersize=12)
axes.text(0.05, -16, "delay")
axes.text(-0.38, 10, "behind the plate")
axes.text(0.42, 75, "mode 1 before,\nwithout the plate", color="#0072B2")
axes.text(0.5, -22, "mode 1 after", color="#0072B2")
axes.text(0.28, -85, "tip, with all modes", color="#D55E00", ha="right")
axes.set(xlabel="time after the first touch (ms)", ylabel="height of the ball above the plate (µm)", ylim=(-140, 160))
plt.show()
