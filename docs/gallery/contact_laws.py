"""
Four contact laws
=================

A ball of 4 g hits a soft stop at 0.3 m/s.  Three laws are fitted to a restitution of 0.6 and to the same
greatest depth.  Their loops of force against depth enclose the same area, the energy that the ball loses.
The loops have different shapes, peak forces and contact times.  Hertz's law loses no energy, so that its
loop is a line.
"""

# %%
# The free ball is a mode of frequency zero; its mass-normalised shape is 1/sqrt(mass) at the contact.
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

from beam import ModalModel
from contact import ImpactOscillator, State, Stop, simulate

mass, speed, e, depth = 4e-3, 0.3, 0.6, 50e-6
ball = ModalModel(omega=[0], decay_rate=[0], phi=[mass**-0.5], participation=[0])
start = State(displacement=[0], velocity=[speed * mass**0.5])


def impact(law):
    """Return the impact, and depth and speed of the ball at 1001 times in the contact."""
    spring = ImpactOscillator(model=ball, stop=Stop(gap=0, law=law))
    impacts = simulate(spring, start, duration=0.1).impacts
    times = np.linspace(0, impacts.duration[0], 1001)
    motion = simulate(spring, start, duration=0.1, times=times)
    return impacts, spring.tip(motion.displacement), spring.tip(motion.velocity)


# %%
# The stiffness k of each law follows from the greatest depth, 50 µm.  A touch ends when the ball is back at
# depth zero.  The force of the linear stop and of the 3/2 power stop vanishes a little before.
from contact import HertzContact, HuntCrossley, LinearContact, PowerContact

fitted = dict(restitution=e, mass=mass)
laws = {
    "linear": lambda k: LinearContact.with_restitution(stiffness=k, **fitted),
    "power 3/2": lambda k: PowerContact.with_restitution(stiffness=k, exponent=1.5, **fitted),
    "Hunt-Crossley": lambda k: HuntCrossley.with_restitution(stiffness=k, restitution=e, velocity=speed),
    "Hertz": lambda k: HertzContact(stiffness=k),
}
colours = "#0072B2", "#009E73", "#D55E00", "0.5"
figure, axes = plt.subplots(figsize=(6, 4.4), layout="constrained")
found = {}
for (name, law), colour in zip(laws.items(), colours, strict=True):
    k = 10 ** brentq(lambda x, law=law: impact(law(10**x))[1].max() / depth - 1, 4, 9)
    found[name] = impacts, x, v = impact(law(k))
    force = -mass * np.gradient(v, impacts.duration[0] / 1000)
    print(f"{name:13}: peak force {impacts.peak_force[0]:.1f} N, {round(1e6 * impacts.loss[0])} µJ lost")
    axes.plot(1e6 * x, force, color=colour, label=f"{name}, {1e3 * impacts.duration[0]:.2f} ms")
axes.legend(title="law, and length of the touch", frameon=False)
axes.set(xlabel="depth (µm)", ylabel="contact force (N)", xlim=(0, 53), ylim=(0, 10))
plt.show()
