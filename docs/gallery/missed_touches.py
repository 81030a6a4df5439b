"""
Missed touches
==============

A program that looks at the tip once in each time step can miss a short touch.  The exact method proves that
it misses none.  Two other methods look for the first touch of 120 motions of a ringing beam.  One evaluates
the exact motion at fixed instants, as an article of 1996 did.  The other is central differences.
"""

# %%
# Six modes of a steel strip are set vibrating, with random phases at the start.
import matplotlib.pyplot as plt
import numpy as np

from beam import STEEL, ConstantRatio, StripSection, assemble, cantilever, natural_modes, reduce
from contact import ImpactOscillator, LinearContact, State, Stop, simulate
from contact.integrators import CentralDifference, SampledFlight

strip = cantilever(length=0.3, section=StripSection(material=STEEL, width=0.02, thickness=0.002))
model = reduce(natural_modes(assemble(strip), 6), ConstantRatio(ratio=0.001))
beam = ImpactOscillator(model=model, stop=Stop(gap=4e-3, law=LinearContact(stiffness=1e5)))
sizes, period = 3.2e-3 * np.array([1, 0.3, 0.15, 0.1, 0.05, 0.05]) / model.phi, model.free_period


def first_touch(start, method=None):
    """Return the time of the first touch in one period of the lowest mode, or infinity."""
    return min(simulate(beam, start, duration=period, method=method).impacts.start, default=np.inf)


# %%
# Only starts in front of the stop are used, and only if the motion touches the stop later.
phases = np.random.default_rng(1).uniform(0, 2 * np.pi, (400, 6))
starts = [State(displacement=sizes * np.cos(p), velocity=sizes * model.omega * np.sin(p)) for p in phases]
starts = [one for one in starts if beam.tip(one.displacement) < 3.5e-3 and first_touch(one) < period][:120]
exact = np.array([first_touch(one) for one in starts])

# %%
# A first touch is wrong if it is missed or differs by more than 0.1 ms.
points = 25 * 2 ** np.arange(9)
methods = [SampledFlight(points=k) for k in points] + [CentralDifference(step=period / k) for k in points[4:]]
touches = np.array([[first_touch(one, method) for one in starts] for method in methods])
wrong = 100 * np.mean(abs(touches - exact) > 1e-4, axis=1)

# %%
# The left panel shows a touch between two samples.  The sampled motion goes on without it.
missed = np.argmax(touches[1] > exact + 1e-3)
times, looks = exact[missed] + np.linspace(-1.5e-3, 2.5e-3, 801), period / points[1] * np.arange(1, points[1])
figure, (left, right) = plt.subplots(1, 2, figsize=(7, 4.4), layout="constrained")
for method, at, look in ((None, times, "k"), (methods[1], times, "C1--"), (methods[1], looks, "C1o")):
    motion = simulate(beam, starts[missed], duration=period, times=at, method=method)
    left.plot(1e3 * (at - exact[missed]), 1e3 * beam.tip(motion.displacement), look)
left.axhspan(4, 4.4, color="0.85", zorder=0)
left.text(-1.4, 4.2, "stop", va="center")
left.text(0.5, 2.6, "exact", ha="right")
left.set(xlabel="time after the touch (ms)", ylabel="tip displacement (mm)", xlim=(-1.5, 2.5), ylim=(2, 4.4))
right.semilogx(1e3 * period / points, wrong[:9], "C1o-", label="sampled")
right.semilogx(1e3 * period / points[4:], wrong[9:], "C0s-", label="central differences")
right.legend(frameon=False, loc="upper left")
right.set(xlabel="time step or sampling (ms)", ylabel="wrong first touches (%)", ylim=(-2, 100))
plt.show()
