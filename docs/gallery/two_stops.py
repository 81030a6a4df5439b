"""
Between two stops
=================

A spring is shaken between two stops at equal distances and hits them in turn.  At small amplitudes the motion
is symmetric: half a drive period later the tip is at the opposite place.  At a larger amplitude the symmetric
motion becomes unstable.  Then the tip hits one stop faster than the other, though nothing distinguishes them.
"""

# %%
# `side=-1` puts a stop on the side of negative displacements.
import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate

model, law = single_mode(free_period=40.80e-3, decay_rate=3.56), NewtonRestitution(local_restitution=0.6)
stops = Stop(gap=8e-3, law=law), Stop(gap=8e-3, law=law, side=-1)
times = np.linspace(398, 400, 2001) / 34


def motion(amplitude):
    """Return 400 drive periods from rest, with the last two in detail."""
    drive = HarmonicDrive(frequency=34, amplitude=amplitude)
    return simulate(ImpactOscillator(model=model, stops=stops, drive=drive), periods=400, times=times)


# %%
# Each impact has the number of its stop.  Its approach speed is positive towards that stop.
small, large = motion(6e-3), motion(9e-3)
for amplitude, impacts in ((6, small.impacts), (9, large.impacts)):
    (first, second), speeds = impacts.stop[-2:], impacts.approach[-2:]
    print(f"base {amplitude} mm: stop {first} at {speeds[0]:.3f} m/s, stop {second} at {speeds[1]:.3f} m/s")

# %%
# The speeds at both stops agree up to a base amplitude of 7.9 mm, where they separate.
amplitudes = np.linspace(2e-3, 9.2e-3, 73)
found = [motion(amplitude).impacts for amplitude in amplitudes]
speeds = [[impacts.approach[impacts.stop == k][-1] for k in (0, 1)] for impacts in found]

figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 4.4), layout="constrained")
left.plot(34 * times - 398, 1e3 * small.oscillator.tip(small.displacement), "k")
left.plot(34 * times - 398, 1e3 * large.oscillator.tip(large.displacement), color="0.55", linestyle="--")
left.axhspan(8, 10, color="#0072B2", alpha=0.3)
left.axhspan(-10, -8, color="#D55E00", alpha=0.3)
left.text(0.05, 8.9, "upper stop", va="center")
left.text(0.05, -9.1, "lower stop", va="center")
left.set_title("base 6 mm, and 9 mm (dashed)", fontsize="medium")
left.set(xlabel="time (drive periods)", ylabel="tip displacement (mm)", xlim=(0, 2), ylim=(-10, 10))
right.plot(1e3 * amplitudes, speeds)
for line, colour in zip(right.lines, ("#0072B2", "#D55E00"), strict=True):
    line.set_color(colour)
right.text(8.3, 2.95, "upper stop ", color="#0072B2", ha="right")
right.text(9.2, 1.85, "lower stop", color="#D55E00", ha="right")
right.text(4.6, 1.7, "both alike ", ha="right")
right.set(xlabel="base amplitude (mm)", ylabel="approach speed (m/s)")
plt.show()
