"""
Which period appears at grazing
===============================

Above grazing the motion often jumps to an orbit p_m, which has one impact in m drive periods.  The drive
frequency decides on m.  Nordmark's map has a band of frequencies for each m, and the bands leave no gaps.
The exact motion of one mode makes the same jump, but mostly in the upper part of the band.
"""

# %%
# The mode has a free period of 40.80 ms and a decay rate of 3.56 1/s.
import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap, frequency_band
from contact.orbits import onset_orbit

mode = dict(free_period=40.80e-3, decay_rate=3.56)
bands = [frequency_band(m, restitution=0.1, **mode) for m in range(3, 11)]
for band in bands:
    print(f"p{band.m}: {band.lower:.2f} to {band.upper:.2f} Hz")

# %%
# Each exact motion starts without impacts.  Then the drive is raised to 0.1 % above grazing.
model, stop = single_mode(**mode), Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
frequencies = np.arange(19.705, 23.34, 0.01)
drives = [HarmonicDrive(frequency=f) for f in frequencies]
springs = [ImpactOscillator(model=model, stop=stop, drive=drive) for drive in drives]
orbits = [onset_orbit(StroboscopicMap(oscillator=one)) for one in springs]
m, impacts = np.array([(orbit.m, orbit.impacts) for orbit in orbits]).T
print(f"one impact in m periods: {np.mean((m > 0) & (impacts == 1)):.0%} of the frequencies")

# %%
# Pale bars are bands of the map.  Dots are exact motions with one impact in m periods.  At a frequency
# without a dot, the exact motion has more impacts, or it has not become periodic.
figure, axes = plt.subplots(figsize=(6, 4.4), layout="constrained")
for band, colour in zip(bands, plt.colormaps["viridis"](np.linspace(0, 0.85, len(bands))), strict=True):
    axes.barh(band.m, band.upper - band.lower, 0.8, band.lower, color=colour, alpha=0.3)
    dots = frequencies[(m == band.m) & (impacts == 1)]
    axes.plot(dots, np.full(dots.size, band.m), ".", color=colour)
axes.text(19.75, 4.1, "bars: Nordmark's map\ndots: exact motion")
axes.set(xlabel="drive frequency (Hz)", ylabel="drive periods from impact to impact, m")
plt.show()
