"""
Peak force
==========

A steel cantilever is shaken at 15 Hz, a little below its lowest frequency, beside a rubber buffer.  The
largest contact force in the first eight drive periods depends on the gap and on the base amplitude.  It is
zero where the stop is out of reach.  Elsewhere it mostly grows with the base amplitude, but not smoothly.
Each impact depends on the phase of the ringing that earlier impacts have left.
"""

# %%
# The buffer has a stiffness of 1e5 N/m.  Eight modes are enough for it; a hard stop needs many more.
import matplotlib.pyplot as plt
import numpy as np

from beam import STEEL, ConstantRatio, StripSection, assemble, cantilever, natural_modes, reduce
from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop, simulate

section = StripSection(material=STEEL, width=0.02, thickness=0.002)
modes = natural_modes(assemble(cantilever(length=0.3, section=section)), 8)
model, law = reduce(modes, ConstantRatio(ratio=0.01)), LinearContact(stiffness=1e5)


def motion(gap, amplitude, times=None):
    """Return the motion from rest, in eight drive periods."""
    drive, stop = HarmonicDrive(frequency=15, amplitude=amplitude), Stop(gap=gap, law=law)
    return simulate(ImpactOscillator(model=model, stop=stop, drive=drive), periods=8, times=times)


# %%
# Each square of the picture is a simulation of its own.  Its force is the maximum of the power series of the
# contact, not of samples.
gaps, amplitudes = np.linspace(0.25e-3, 9.25e-3, 37), np.linspace(0.05e-3, 2e-3, 40)
force = np.array([[motion(gap, z).impacts.peak_force.max(initial=0.0) for z in amplitudes] for gap in gaps])
i, j = np.unravel_index(force.argmax(), force.shape)
print(f"The largest force is {force[i, j]:.0f} N, at a gap of {1e3 * gaps[i]:.2f} mm.")

# %%
# With the stop out of reach the motion is free, and proportional to the base amplitude.
free = motion(0.1, 1e-3, np.linspace(0, 8 / 15, 8001))
factor = free.oscillator.tip(free.displacement).max() / 1e-3
print(f"The free tip moves at most {factor:.2f} times as far as the base.")

# %%
# The dashed line is the largest gap that the free tip reaches.
figure, axes = plt.subplots(figsize=(7, 4.8), layout="constrained")
shown = np.ma.masked_equal(force, 0)
colours = axes.pcolormesh(1e3 * amplitudes, 1e3 * gaps, shown, cmap="viridis")
figure.colorbar(colours, label="largest contact force (N)")
axes.plot(1e3 * amplitudes, 1e3 * factor * amplitudes, "--", color="#D55E00")
axes.text(0.4, 7, "stop out of reach:\nno force", ha="center")
axes.text(1.2, 5.9, "largest free\ndisplacement", color="#D55E00", ha="right")
axes.set(xlabel="base amplitude (mm)", ylabel="gap (mm)", ylim=(0, 9.4))
plt.show()
