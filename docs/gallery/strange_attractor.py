"""
A strange attractor
===================

A spring with a restitution of 0.95 can move chaotically: its motion never repeats.  Its strobes, one point in
each drive period, form a set of layers within layers, a strange attractor.  The largest Lyapunov exponent is
the mean rate at which neighbouring motions separate.  It is positive in chaos.
"""

# %%
# The drive of 24 Hz, near resonance, is twice as large as the grazing amplitude.
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
# The colour of a strobe shows whether the tip has hit the stop in the drive period before.  The right panel
# enlarges the frame: each layer consists of thinner layers.
strobes = strobed.orbit(start, 200000)
x, v = 1e3 * strobes.points[:, 0], spring.model.omega[0] * strobes.points[:, 1]
hit = strobes.impacts > 0
figure, panels = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained")
for axes, size in zip(panels, (0.2, 0.5), strict=True):
    axes.plot(x[hit], v[hit], ".", color="#D55E00", markersize=size)
    axes.plot(x[~hit], v[~hit], ".", color="#0072B2", markersize=size)
    axes.set_xlabel("strobed displacement (mm)")
frame = dict(xlim=(-0.9, -0.3), ylim=(0.718, 0.728))
panels[0].add_patch(plt.Rectangle((-0.9, 0.718), 0.6, 0.01, fill=False))
panels[0].set(ylabel="strobed velocity (m/s)")
panels[0].text(-0.7, 0.663, "no impact", color="#0072B2")
panels[0].text(-2.6, 0.715, "impact", color="#D55E00")
panels[1].set(**frame)
plt.show()
