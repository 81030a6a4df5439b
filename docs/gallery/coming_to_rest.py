"""
Coming to rest on a stop
========================

A constant force presses a spring against its stop.  A slowly shaken base pulls the tip off once in each
drive period.  The tip falls back and bounces.  Each low hop lasts 0.7 times as long as the one before,
where 0.7 is the restitution, so that infinitely many end in a finite time.  Then the tip rests on the stop,
until the base pulls it off again.
"""

# %%
# Without the stop, the force would hold the tip at 4.4 mm.  The stop is at 4 mm.
import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactKind, ImpactOscillator, NewtonRestitution, Stop, simulate

model = single_mode(free_period=40.80e-3, decay_rate=3.56)
spring = ImpactOscillator(
    model=model,
    stop=Stop(gap=4e-3, law=NewtonRestitution(local_restitution=0.7)),
    drive=HarmonicDrive(frequency=5, amplitude=15e-3),
    load=model.load_of({"tip": 105}),
)
impacts = simulate(spring, periods=5).impacts

# %%
# A touch of the kind `STAY` is a rest.  It begins after the last hop, however low.
rests = np.flatnonzero(impacts.kind == ImpactKind.STAY)
before, after = rests[-2:]
leaves, start, end = impacts.end[before], impacts.start[before], impacts.end[after]
landings = impacts.start[before + 1 : after]
hops = np.diff(landings)
print(f"The tip leaves, hits the stop {landings.size} times, and rests for {impacts.duration[after]:.3f} s.")
print("Last hops over the hops before them:", *(hops[-4:] / hops[-5:-1]).round(4))

# %%
# Dots are impacts, and bars are rests.  In the small panel each hop is 0.7 times as long as the one before.
times = np.linspace(leaves - 0.02, end + 0.02, 4001)
motion = simulate(spring, periods=6, times=times)
figure, axes = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
axes.plot(1e3 * (times - leaves), 1e3 * spring.tip(motion.displacement), "k")
axes.plot(1e3 * (landings - leaves), np.full(landings.size, 4), "o", color="#D55E00")
for bar in ([start, leaves], [impacts.start[after], end]):
    axes.plot(1e3 * (np.array(bar) - leaves), [4, 4], color="#0072B2", linewidth=6)
axes.axhspan(4, 4.05, color="0.85", zorder=0)
axes.text(140, 4.025, "stop", ha="center", va="center")
axes.text(140, 3.97, "rest", color="#0072B2", ha="center", va="top")
axes.set(
    xlabel="time after the take-off (ms)", ylabel="tip displacement (mm)", xlim=(-20, 220), ylim=(3.64, 4.05)
)
small, number = axes.inset_axes((0.51, 0.14, 0.38, 0.52)), np.arange(1, hops.size + 1)
small.semilogy(number, 1e3 * hops, "o", color="#D55E00", markersize=3)
small.semilogy(number, 1e3 * hops[-1] * 0.7 ** (number - hops.size), "k", linewidth=1)
small.set(xlabel="number of the hop", ylabel="length of the hop (ms)")
plt.show()
