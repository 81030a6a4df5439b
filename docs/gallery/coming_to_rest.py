"""
Coming to rest on a stop
========================

A constant force presses a spring against its stop.  A slowly shaken base pulls the tip off once in each drive
period.  The tip falls back and bounces, and its hops become shorter by the restitution.  Infinitely many
impacts take place in a finite time.  After them the tip rests on the stop, until the base pulls it off again.
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
# A touch of the kind `STAY` is a rest.  It begins after all hops, also after the ones below rounding.
rests = np.flatnonzero(impacts.kind == ImpactKind.STAY)
before, after = rests[-2:]
leaves, start, end = impacts.end[before], impacts.start[before], impacts.end[after]
landings = impacts.start[before + 1 : after]
hops = np.diff(landings)
print(f"The tip leaves, hits the stop {landings.size} times, and rests for {impacts.duration[after]:.3f} s.")
print("Last hops over the hops before them:", *(hops[-4:] / hops[-5:-1]).round(4))

# %%
# Dots are impacts, and bars are rests.  The line on the right falls by the restitution 0.7 in each hop.
times = np.linspace(leaves - 0.02, end + 0.02, 4001)
motion = simulate(spring, periods=6, times=times)
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained", width_ratios=(3, 2))
left.plot(1e3 * (times - leaves), 1e3 * spring.tip(motion.displacement), "k", linewidth=1)
left.plot(1e3 * (landings - leaves), np.full(landings.size, 4), "o", color="#D55E00", markersize=4)
for since, until in ((start, leaves), (impacts.start[after], end)):
    left.plot(1e3 * (np.array([since, until]) - leaves), [4, 4], color="#0072B2", linewidth=5)
left.axhspan(4, 4.08, color="0.8", zorder=0)
left.text(50, 4.04, "stop", va="center")
left.text(140, 3.96, "rest", color="#0072B2", ha="center", va="top")
left.text(64, 3.85, "hops", color="#D55E00")
left.set(xlabel="time after the take-off (ms)", ylabel="tip displacement (mm)")
left.set(xlim=(-20, 220), ylim=(3.65, 4.08))
number = np.arange(1, hops.size + 1)
right.semilogy(number, 1e3 * hops, "o", color="#D55E00", markersize=4)
right.semilogy(number, 1e3 * hops[-1] * 0.7 ** (number - hops.size), "k", linewidth=1)
right.set(xlabel="number of the hop", ylabel="length of the hop (ms)")
plt.show()
