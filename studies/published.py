"""What the letter of 1996 prints, by figure: the numbers that results are held against.

Two misprints of the stored text are corrected where they are used (``contact.nordmark``): the y-line of the
map after an impact is -gamma tau^2 x, and the bracket in rho reads (1 + tau)^2 sin^2(2 pi/(f T)).  Apart from
them, "rho = F/F_g - 1" under Fig. 4 is the excess, not the map's rho; the -0.0707 in the text on Fig. 5 may
be either.
"""

from __future__ import annotations

from types import MappingProxyType

__all__ = [
    "AMPLITUDE_STABILITY_M",
    "BREAKDOWN",
    "DRIVE_AMPLITUDE_M",
    "FREE_PERIOD_ERROR_S",
    "FREE_PERIOD_S",
    "PERIODS",
    "RESTITUTION",
    "SETTLE_CYCLES",
    "STROBE_POINTS",
    "TIME_TRACE_EXCESS",
]

FREE_PERIOD_S, FREE_PERIOD_ERROR_S = 40.80e-3, 0.02e-3
"""Fig. 2: period of the freely swinging beam [s]."""

PERIODS = MappingProxyType({20.90: 3, 21.50: 4, 22.20: 5, 22.60: 6, 23.05: 8, 23.40: 10})
"""Fig. 2: drive frequency [Hz] -> m of the transition p1 <-> pm."""

RESTITUTION = 0.1
"""Text: "estimated to be tau ~ 0.1"."""

DRIVE_AMPLITUDE_M, AMPLITUDE_STABILITY_M = 2e-3, 0.5e-6
"""Text: typical amplitude of the base and its long-term stability [m]."""

TIME_TRACE_EXCESS = 0.013
"""Fig. 4: excess of the period-4 time trace."""

SETTLE_CYCLES, STROBE_POINTS = 10_000, 40
"""Fig. 5: drive periods waited at each amplitude, and strobe points drawn."""

BREAKDOWN = MappingProxyType(
    {
        "frequency_hz": 19.65,
        "free_period_s": 41.2e-3,
        "free_period_error_s": 0.1e-3,
        "decay_rate_per_s": 3.56,
        "decay_rate_error_per_s": 0.1,
        "born_period": 6,
        "chaos_at": -0.0707,
    }
)
"""Fig. 5 and its text."""
