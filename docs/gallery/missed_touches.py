"""
Missed touches
==============

A program that looks at the tip once in each time step can miss a short touch.  The exact method of the
package proves that it misses none.  Two other methods are compared with it on 200 motions of a ringing beam.
One samples exact flights, as the letter did; the other, central differences, has a time step.
"""

# %%
# Six modes of a steel strip ring.  At the start they have random phases.
import matplotlib.pyplot as plt
import numpy as np

from beam import STEEL, ConstantRatio, StripSection, assemble, cantilever, natural_modes, reduce
from contact import ImpactOscillator, LinearContact, State, Stop, simulate
from contact.integrators import CentralDifference, SampledFlight

section = StripSection(material=STEEL, width=0.02, thickness=0.002)
model = reduce(natural_modes(assemble(cantilever(length=0.3, section=section)), 6), ConstantRatio(ratio=0.001))
beam = ImpactOscillator(model=model, stop=Stop(gap=4e-3, law=LinearContact(stiffness=5e3)))
sizes, period = 3.2e-3 * np.array([1, 0.3, 0.15, 0.1, 0.05, 0.05]) / model.phi, model.free_period


def first_touch(start, method=None):
    """Return the time of the first touch in one period of the lowest mode, or infinity."""
    return min(simulate(beam, start, duration=period, method=method).impacts.start, default=np.inf)


# %%
# Starts that lie near or behind the stop are left out, and motions without a touch.
phases = np.random.default_rng(1).uniform(0, 2 * np.pi, (400, 6))
starts = [State(displacement=sizes * np.cos(p), velocity=sizes * model.omega * np.sin(p)) for p in phases]
starts = [one for one in starts if beam.tip(one.displacement) < 3.5e-3 and first_touch(one) < period][:200]
exact = np.array([first_touch(one) for one in starts])
points = 25 * 2 ** np.arange(9)
methods = {"sampled": [SampledFlight(points=k) for k in points]}
methods["central"] = [CentralDifference(step=period / k) for k in points if k > 400]
wrong = {}
for name, tried in methods.items():
    touches = np.array([[first_touch(one, method) for one in starts] for method in tried])
    wrong[name] = np.mean(abs(touches - exact) > 1e-4, axis=1)
    print(name, wrong[name])
plt.subplots()
plt.show()
