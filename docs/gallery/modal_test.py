"""
From a modal test to impacts
============================

A modal test of a structure gives poles and residues.  `ModalModel.from_residues` turns them into the modes
that impacts need.  There are two tests: a hammer hits the tip, and a shaker moves the base.  This example
simulates both on a computed cantilever, so that the true modes are known.
"""

# %%
# The "structure" is a steel strip of 30 cm with a ball of 10 g.  It is computed with twelve modes.  The tests
# see four of them.
import matplotlib.pyplot as plt
import numpy as np

from beam import (
    STEEL,
    ConstantRatio,
    ModalModel,
    StripSection,
    Tip,
    assemble,
    cantilever,
    natural_modes,
    reduce,
)
from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop, simulate

section = StripSection(material=STEEL, width=0.02, thickness=0.002)
strip = cantilever(length=0.3, section=section, tip=Tip(mass=0.01))
true = reduce(natural_modes(assemble(strip), 12), ConstantRatio(ratio=0.01))

# %%
# A program for modal analysis gives a complex pole and two complex residues for each mode.  Each
# residue has a random error of about 1 %.
noise = 1 + 0.01 * np.random.default_rng(3).standard_normal((2, 4))
seen = true.truncated(4)
damped = np.sqrt(seen.omega**2 - seen.decay_rate**2 / 4)
poles = -seen.decay_rate / 2 + 1j * damped  # rad/s
hammer = noise[0] * seen.phi**2 / (2j * damped)  # m/(N s)
shaker = noise[1] * -seen.participation * seen.phi / (2j * damped)  # s
measured = ModalModel.from_residues(poles=poles, force_residues=hammer, base_residues=shaker)
print("computed phi", *(f"{value:6.3f}" for value in seen.phi), "kg^(-1/2)")
print("measured phi", *(f"{value:6.3f}" for value in measured.phi), "kg^(-1/2)")

# %%
# Both models are driven at 14 Hz beside a rubber buffer, from rest.  A soft buffer hardly excites the modes
# that the tests did not see.
stop = Stop(gap=3e-3, law=LinearContact(stiffness=1e4, damping=2))
drive, times, runs = HarmonicDrive(frequency=14, amplitude=1e-3), np.linspace(0, 1, 3001), {}
for name, model in (("computed", true), ("measured", measured)):
    rig = ImpactOscillator(model=model, stop=stop, drive=drive)
    run = runs[name] = simulate(rig, duration=1, times=times)
    print(f"{name}: {len(run.impacts)} impacts, largest force {run.impacts.peak_force.max():.1f} N")

figure, panels = plt.subplots(2, 1, sharex=True, sharey=True, figsize=(7.5, 4.8), layout="constrained")
for axes, (name, run), colour in zip(panels, runs.items(), ("#0072B2", "#D55E00"), strict=True):
    run.plot(axes, color=colour)
    axes.set_title(f"{name} modes", color=colour, loc="left")
plt.show()
