"""SDNL111 of code_aster: two uniform bars of 1 m, tip to tip, the far end of the second held.

u'' = c^2 u_xx, mass m, T = L/c, impedance J = m/T. A force F(t) on one end moves that end with
(F(t) + 2 sum_n s^n F(t - 2 n T))/J, s = 1 if the far end is free and -1 if it is held: the exact motion
follows. Modes, omega T and phi sqrt(m) at the end: k pi and sqrt(2), 1 for k = 0 (free), (k + 1/2) pi (held).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import lambertw

from beam import ModalModel
from contact import ImpactOscillator, LinearContact, State, Stop, simulate
from studies.methods.validation.printed import Printed, compared
from studies.shell.digits import written

Array = NDArray[np.float64]
PRINTED = {0.2: -0.1, 0.4: -0.2, 0.6: -0.1, 0.8: 0.0, 1.0: 0.2}
"""Time [ms] -> displacement [mm] of the contact end of the first bar, which arrives at 1 m/s."""

MODES, STIFFNESS, ROOT_MASS, WAVE = 400, 5e9, math.sqrt(3.12), math.sqrt(2e11 / 7800.0)
"""Modes of each bar; stiffness of the contact [N/m]; root of the mass [kg^0.5]; speed of waves [m/s]."""


def series(count: int, held: bool) -> tuple[Array, Array]:
    """The first exact modes: omega T and phi sqrt(m)."""
    k = np.array([i + 0.5 * held for i in range(count)])
    return math.pi * k, np.where(k == 0.0, 1.0, math.sqrt(2.0))


def met(times: Array, transit: float, lag: float) -> Array:
    """Place of the first bar's contact end at 1 m/s [m] up to 6 T; with lag = J/(2 k) [s] the force is
    J (1 - exp(-t/lag))/2 to 4 T, then J ((1 + s) exp(-s) - 1/2), s = (t - 4 T)/lag, down to zero."""
    end, place = -lambertw(-0.5 / math.e, -1).real - 1.0, -times
    for back, count in ((0.0, 1.0), (2.0 * transit, 2.0), (4.0 * transit, 2.0)):  # impulse of F/J
        rise = np.clip(times - back, 0.0, 4.0 * transit)
        s = np.clip((times - back - 4.0 * transit) / lag, 0.0, end)
        fall = 4.0 - s - 2.0 * (2.0 + s) * np.exp(-s)
        place = place + 0.5 * count * (rise + lag * np.expm1(-rise / lag) + lag * fall)
    return place


def two_bars() -> list[Printed]:
    """The contact end of the first bar at the printed times, beside the exact wave."""
    (free, tip), (held, other) = series(MODES, False), series(MODES, True)
    omega, phi = (
        WAVE * np.append(free, held),
        np.append(-tip, other) / ROOT_MASS,
    )  # positive when they approach
    model = ModalModel(omega=omega, decay_rate=0.0 * omega, phi=phi, participation=0.0 * omega)
    bars = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=LinearContact(stiffness=STIFFNESS)))
    start = State(displacement=0.0 * omega, velocity=-ROOT_MASS * (np.arange(omega.size) == 0))
    times = 1e-3 * np.array(list(PRINTED))
    run = simulate(bars, start, duration=1e-3, times=times)
    found = run.displacement[:, :MODES] @ tip / ROOT_MASS
    exact = met(times, 1.0 / WAVE, 0.5 * ROOT_MASS**2 * WAVE / STIFFNESS)
    return [
        compared(
            "SDNL111",
            f"contact end at {time} ms",
            1e-3 * printed,
            float(ours),
            0.05e-3 * abs(printed or 0.2),  # at zero 5 % of the largest
            f"exact wave {written(wave)} m",
            "m",
        )
        for (time, printed), ours, wave in zip(PRINTED.items(), found, exact, strict=True)
    ]
