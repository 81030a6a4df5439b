"""The whole package in one short script, from a strip to an orbit.

The letter's Fig. 4 (1996): a U with legs of 13 cm, driven at 21.50 Hz, 1.3 % above grazing. Each cell prints
what it found. Command: python -m studies tour, or cell by cell in an editor that knows `# %%`. It has no
options: copy it and change it. Output: results/tour.png and .pdf, and three records as CSV.
"""

# %% A U cut out of a sheet of brass, damping tape on its legs; a ceramic ball with its mount at the bend
from dataclasses import replace

from beam import BRASS, DAMPING_TAPE, Layer, StripSection, Tip, flat_u

bare = StripSection(material=BRASS, width=12e-3, thickness=1.176e-3)
taped = replace(bare, layer=Layer(material=DAMPING_TAPE, thickness=0.45e-3))
ball = Tip(mass=6.83e-3)
spring = flat_u(leg_length=0.13, bend_radius=9e-3, section=bare, damped_section=taped, tip=ball)

# %% Its modes by finite elements: the first 12, with the decay measured for the lowest
import numpy as np

from beam import MeasuredDecay, assemble, natural_modes, reduce

model = reduce(natural_modes(assemble(spring), count=12), MeasuredDecay(decay_rate=3.56), 12)
print("modes (Hz):", *np.round(model.frequencies_hz[:5], 1), "...")
print(f"free period {1e3 * model.free_period:.2f} ms; the letter measured 40.80")

# %% A steel plate 11.9 mm away, Hertz contact, the base shaken at 21.50 Hz
from contact import HarmonicDrive, HertzContact, ImpactOscillator, Stop, StroboscopicMap

law = HertzContact.of_bodies(
    radius=2.5e-3, youngs_modulus=370e9, poissons_ratio=0.22, other_modulus=210e9, other_ratio=0.29
)
oscillator = ImpactOscillator(
    model=model, stop=Stop(gap=11.88e-3, law=law), drive=HarmonicDrive(frequency=21.5)
)
print(f"the ball grazes the plate when the base moves by {1e3 * oscillator.grazing_amplitude():.2f} mm")
oscillator = oscillator.with_excess(0.013)

# %% Seen once in each drive period, the motion settles on an orbit
strobed = StroboscopicMap(oscillator=oscillator)
settled = strobed.orbit(strobed.steady(), 1000).end
again = strobed.orbit(settled, 8)
print("impacts in each drive period:", *again.impacts, "- one in four, p4")
print(f"it repeats after four periods, to {abs(again.points[7] - again.points[3]).max():.0e} m")

# %% One collision, as the first mode feels it
from contact import collisions, simulate

times = settled.time + np.linspace(0.0, 4.0 * oscillator.period, 4001)
motion = simulate(oscillator, settled, periods=5, times=times)
hit = collisions(motion)[0]
print(f"effective restitution {hit.restitution:.2f}, delay {1e3 * hit.delay:.2f} ms, kick {hit.kick:.2f}")

# %% How far below grazing the orbit remains: followed to its fold
from contact.orbits import Shooting, fold_of

fold = fold_of(Shooting(oscillator=oscillator, m=4))
assert fold is not None
print(f"p4 ends {-100 * fold.excess:.2f} % below grazing; Floquet multiplier {fold.multipliers[0].real:.6f}")

# %% The picture: ball and plate over one orbit
from pathlib import Path

from matplotlib.figure import Figure

figure = Figure(figsize=(7.0, 3.8), layout="constrained")
axes, strobes = figure.subplots(), oscillator.tip(motion.strobe_displacement[:4])
touch = hit.first_touch - settled.time
axes.plot(1e3 * (times - settled.time), 1e3 * oscillator.tip(motion.displacement), label="ball")
axes.axhline(1e3 * oscillator.stop.gap, color="0.5", linestyle="--", label="plate")
axes.axvline(1e3 * touch, color="tab:red", linestyle=":", label="impact")
axes.plot(
    1e3 * (motion.strobe_time[:4] - settled.time), 1e3 * strobes, "ko", label="seen once in each drive period"
)
axes.set(xlabel="time (ms)", ylabel="displacement (mm)", title="p4: one impact in four drive periods")
figure.legend(loc="outside lower center", ncols=4, frameon=False)
folder = Path("results")
folder.mkdir(parents=True, exist_ok=True)
for path in (folder / "tour.png", folder / "tour.pdf"):
    figure.savefig(path, dpi=150)
    print("drawn in", path)

# %% Records of this rig as an experiment gives them, for `python -m studies identify results/tour_strobe.csv`
rig = f"# frequency_hz = 21.5\n# amplitude_m = {oscillator.driven.amplitude!r}\n"
noise = np.random.default_rng(1996).normal(0.0, 0.5e-6, (40 + times.size, 1))  # of the read-out, in metres
seen = np.tile(strobes[:, None], (10, 1)) + noise[:40]
trace = np.column_stack([times - settled.time, oscillator.tip(motion.displacement) + noise[40:, 0]])
table = np.array([[21.5, 4, fold.excess, 2.5e-4]])
for name, rows, heading in (
    ("strobe", seen, f"{rig}x_m"),
    ("displacement", trace, f"{rig}time_s,x_m"),
    ("transitions", table, "frequency_hz,period,excess,error"),
):
    np.savetxt(folder / f"tour_{name}.csv", rows, "%.9g", ",", header=heading, comments="")
