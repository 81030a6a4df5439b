"""
A strange attractor
===================

A spring with a restitution of 0.95 can move chaotically: its motion never repeats.  Its strobes, one point in
each drive period, form a set of layers within layers, a strange attractor.  The largest Lyapunov exponent is
the mean rate at which neighbouring motions separate.  It is positive in chaos.
"""

# %%
# The base moves at 24 Hz, near resonance, with twice the grazing amplitude.
import matplotlib.pyplot as plt

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
from contact.orbits import map_exponents

spring = ImpactOscillator(
    model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    stop=Stop(gap=5e-3, law=NewtonRestitution(local_restitution=0.95)),
    drive=HarmonicDrive(frequency=24),
).with_excess(1)
strobed = StroboscopicMap(oscillator=spring)

# %%
# The first 1000 drive periods are left out.  The exponent is a mean over the next 5000.
start = strobed.orbit(strobed.at(-1e-3).steady(), 1000).end
exponents, _ = map_exponents(strobed, start, 5000)
print(f"largest Lyapunov exponent: {exponents.largest:.2f} per drive period")

# %%
# The colour of a strobe shows whether the tip has hit the stop in the drive period before.  The small panel
# enlarges a part: each layer consists of thinner layers.
strobes = strobed.orbit(start, 200000)
x, v = 1e3 * strobes.points[:, 0], spring.model.omega[0] * strobes.points[:, 1]
hit = strobes.impacts > 0
figure, axes = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
small = axes.inset_axes((0.03, 0.55, 0.4, 0.42), xlim=(-0.9, -0.3), ylim=(0.718, 0.728), xticks=[], yticks=[])
for panel in (axes, small):
    panel.plot(x[hit], v[hit], ".", color="#D55E00", markersize=0.4)
    panel.plot(x[~hit], v[~hit], ".", color="#0072B2", markersize=0.4)
axes.indicate_inset_zoom(small, edgecolor="k", alpha=1)
axes.text(-0.5, 0.7, "impact", color="#D55E00")
axes.text(-0.9, 0.668, "no impact", color="#0072B2")
axes.set(xlabel="strobed displacement (mm)", ylabel="strobed velocity (m/s)", xlim=(-4.6, 0.3))
plt.show()
