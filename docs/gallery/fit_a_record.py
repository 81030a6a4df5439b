"""
From a record to a prediction
=============================

A beam rattles against a stop, and its motion was recorded.  This example reads the file, fits the oscillator
and predicts where the orbit is lost.  ``python -m studies identify bench.csv`` does the first two steps.
"""

# %%
# The recorder wrote decimal commas and micrometres, and lost one value.  The sensor has a noise of 5 µm.
# Here a simulation makes the record, so that the true values are known.
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate
from contact.orbits import MaximalFamily
from studies.measurement.identify.fit.search import fit
from studies.measurement.identify.record.reading import read_record

stop = Stop(gap=8.5e-3, law=NewtonRestitution(local_restitution=0.1))
model, drive = single_mode(free_period=0.0402, decay_rate=3.2), HarmonicDrive(frequency=21.9)
bench = ImpactOscillator(model=model, stop=stop, drive=drive).with_excess(4e-3)
settled, times = simulate(bench, periods=800).end, np.arange(3000) / 2000
motion = simulate(bench, settled, periods=40, times=settled.time + times)
seen = motion.tip + 5e-6 * np.random.default_rng(4).standard_normal(times.size)
rows = [f"{time:.4f};{1e6 * x:.1f}".replace(".", ",") for time, x in zip(times, seen, strict=True)]
rows[400] = "0,2;overload"
file = Path(mkdtemp()) / "bench.csv"
file.write_text("Zeit [s];Weg [µm]\n" + "\n".join(rows), encoding="latin-1")

# %%
# The reader finds the units and the lost value.  The fit begins at round numbers, and finds the drive.
record = read_record(file)
print(record.reading, *record.notes, sep="\n")
stop = Stop(gap=5e-3, law=NewtonRestitution(local_restitution=0.5))
model, drive = single_mode(free_period=0.05, decay_rate=1), HarmonicDrive(frequency=25, amplitude=1e-3)
guess = ImpactOscillator(model=model, stop=stop, drive=drive)
fitted = fit(record, guess, ("free_period", "decay_rate", "gap", "amplitude", "restitution", "frequency"))
for name, value, error in zip(fitted.names, fitted.estimate, fitted.errors, strict=True):
    print(f"{name:12} {value:11.4g} ± {error:.1g}")  # in SI units

# %%
# The residuals scatter by 5 µm, the noise of the sensor: the model is large enough.
time, x = record.rows[:1000].T
figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(7.5, 4.8), layout="constrained")
above.plot(time, 1e3 * x, ".", color="0.7")
above.plot(time, 1e3 * (x - fitted.residuals[:1000, 0]), linewidth=1)
above.set(ylabel="tip (mm)", title="record (grey) and fit")
below.plot(time, 1e6 * fitted.residuals[:1000, 0], ".", markersize=2)
below.set(xlabel="time (s)", ylabel="record less fit (µm)")
plt.show()

# %%
# The motion repeats after four drive periods: it is p4.  When the drive is lowered, p4 is lost at its fold.
predicted, true = (MaximalFamily(oscillator=one, m=4).fold() for one in (fitted.oscillator, bench))
print(f"p4 is lost at {1e3 * predicted.amplitude:.4f} mm (true: {1e3 * true.amplitude:.4f} mm)")
