"""
The first graze
===============

A leaf spring with one mode is shaken beside a stop.  Below the grazing amplitude its tip does not reach the
stop, and it moves as a sine.  Just above, the first impact is very slow.  A drive that is larger by 0.2 % is
nevertheless enough for a different motion, with one impact in four drive periods.  The reason is a square
root: the approach speed of the first impact grows as the square root of the excess over grazing.
"""

# %%
# The free spring oscillates with a period of 40.80 ms.  The base moves at 21.5 Hz, and the gap is 11.9 mm.
import matplotlib.pyplot as plt
import numpy as np

from beam import single_mode
from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap, simulate

spring = ImpactOscillator(
    model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    stop=Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1)),
    drive=HarmonicDrive(frequency=21.5),
)
print(f"The tip grazes the stop when the base moves by {1e3 * spring.grazing_amplitude():.3f} mm.")

# %%
# Both simulations start from the steady motion that the spring would have without a stop.  The later part
# is drawn.
times = spring.period * np.linspace(40, 52, 3001)
motions = {}
for excess in (-1e-3, 1e-3):
    driven = spring.with_excess(excess)
    motions[excess] = simulate(driven, StroboscopicMap(oscillator=driven).steady(), periods=52, times=times)

impacts = motions[1e-3].impacts
square_root = spring.unit_speed * np.sqrt(2 * 1e-3)
print(f"The first impact has {impacts.approach[0]:.4f} m/s; the square root gives {square_root:.4f} m/s.")
print("Impacts in each drive period:", *motions[1e-3].strobe_impacts[-8:])

# %%
# The dots are the impacts.
figure, panels = plt.subplots(2, 1, sharex=True, sharey=True, figsize=(7.5, 4.8), layout="constrained")
words = "drive 0.1 % below grazing: no impact", "drive 0.1 % above grazing: one impact in four periods"
colours = "#0072B2", "#D55E00"
for axes, motion, title, colour in zip(panels, motions.values(), words, colours, strict=True):
    axes.plot(times / spring.period - 40, 1e3 * spring.tip(motion.displacement), color=colour)
    axes.axhspan(11.9, 15, color="0.8")
    axes.text(11.9, 13.3, "stop", ha="right", va="center")
    axes.set_title(title, color=colour, loc="left")
    axes.set(ylabel="tip displacement (mm)", xlim=(0, 12), ylim=(-17, 15))
late = impacts.start / spring.period - 40
axes.plot(late[late > 0], np.full(np.sum(late > 0), 11.9), "ko")
axes.set_xlabel("time (drive periods of 46.5 ms)")
plt.show()
