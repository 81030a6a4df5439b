"""What the letter of 1996 prints, by figure: the numbers that results are held against.

Two misprints of the stored text are corrected where they are used (``contact.NordmarkMap``): the y-line of
the map after an impact is -gamma tau^2 x, and the bracket in rho reads (1 + tau)^2 sin^2(2 pi/(f T)).  Apart
from them, "rho = F/F_g - 1" under Fig. 4 is the excess, not the map's rho; the -0.0707 in the text on Fig. 5
may be either.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

FREE_PERIOD_S, FREE_PERIOD_ERROR_S = 40.80e-3, 0.02e-3  # Fig. 2: period of the freely swinging beam [s]

PERIODS = MappingProxyType({20.90: 3, 21.50: 4, 22.20: 5, 22.60: 6, 23.05: 8, 23.40: 10})
"""Fig. 2: drive frequency [Hz] -> m of the transition p1 <-> pm."""

TRANSITION_HZ = MappingProxyType({m: frequency for frequency, m in PERIODS.items()})
"""The same the other way round: m -> drive frequency [Hz]."""

RESTITUTION = 0.1  # text: "estimated to be tau ~ 0.1"

DRIVE_AMPLITUDE_M, AMPLITUDE_STABILITY_M = 2e-3, 0.5e-6
"""Text: typical amplitude of the base and its long-term stability [m]."""

AMPLITUDE_STABILITY = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M  # the same as an excess [1]

TIME_TRACE_HZ, TIME_TRACE_EXCESS = 21.50, 0.013
"""Fig. 4: drive frequency [Hz] and excess of the period-4 time trace."""

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


@dataclass(frozen=True)
class Statement:
    """One thing that the letter says: where, its words or close to them, its number, the study that judges
    it."""

    where: str
    says: str
    printed: str
    study: str


_BEFORE, _AFTER = (
    """\
period_adding | claims | introduction | no number
    The overdamped oscillator has an infinite series of period addings.
torsion | shape | Fig. 1 and text | no number
    The spring is U shaped to suppress torsional modes.
drive_amplitude | calibrate | text after Fig. 1 | typically 2 mm
    Amplitude of the excitation.
free_period | modes | Fig. 2 | 40.80 +- 0.02 ms
    Period T of the freely swinging beam.
""",
    """\
coexistence | chart | text on Fig. 2 | hysteretic
    Below grazing the motion without impacts and p_m coexist.
last_period | last_period | text on Fig. 2 | p10
    The highest observed period is at the limit of resolution and stability.
bands | hysteresis | text on Fig. 3 | no number
    The transitions occur in bands; the hysteresis is zero at the upper edge and grows towards the lower.
hysteresis | hysteresis | Fig. 3 | curves only
    The measured hysteresis differs from the map's, because of higher modes.
neighbour_band | hysteresis | Fig. 3 | a few cases
    p_m orbits continue to exist in the region of one period less.
time_trace | time_trace | Fig. 4 | p4
    Period of the orbit at excess 0.013.
many_modes | time_trace | Fig. 4 | a multitude
    Higher modes excited at impact.
restitution_on_orbit | time_trace | text after Fig. 3 | about 0.1
    Restitution, on the orbit of Fig. 4.
restitution | effective_impact | text after Fig. 3 | about 0.1
    The restitution coefficient is estimated from the loss in a collision.
loss | claims | text after Fig. 4 | no number
    The hysteresis falls with rising energy loss per collision.
secondary | claims | text after Fig. 4 | no number
    Secondary bifurcations lie above grazing in the map, and may lie below it in Eq. (1).
chaos | chart | text after Fig. 4 | no number
    Other transitions occur; these may even be to chaotic states.
breakdown | breakdown | Fig. 5 | p6
    At grazing the motion without impacts gives way to period 6, where the map has p3.
breakdown_p3 | breakdown | Fig. 5 | at its very end
    p3 is found only at the very end of the downward scan.
island | breakdown | text on Fig. 5 | -0.0707
    Eq. (1) has a chaotic state there that is not connected to the one born at grazing.
delay | effective_impact | text after Fig. 5 | no number
    Higher modes introduce a time delay at impact (here at the excess of Fig. 4, 0.013).
soft_wall | soft_wall | last page | larger as K decreases
    A soft wall affects the bifurcations near grazing.
smoothing | soft_wall | last page | not observed
    Higher modes do not effectively smooth the singularity: its secondary bifurcations were not seen.
universality | claims | last paragraph | no number
    The same structure is expected in a wide class of impacting systems.
two_parameters | hysteresis | last paragraph | no number
    Energy loss and time delay represent the higher modes in a single-mode description.
two_parameters_born | transitions | last paragraph | no number
    With these two parameters the single mode has the bifurcations of the beam.
sampled | work_precision | note [11] | no number
    Positions are computed at a few points per period; crossings must not be missed.
""",
)


def _points(table: str) -> dict[str, Statement]:
    """The points of a table whose lines are, in turn, `key | study | where | printed` and what the letter
    says."""
    lines = table.splitlines()
    found = {}
    for line, says in zip(lines[::2], lines[1::2], strict=True):
        key, study, where, printed = line.split(" | ")
        found[key] = Statement(where, says.strip(), printed, study)
    return found


POINTS: Mapping[str, Statement] = MappingProxyType(
    _points(_BEFORE)
    | {
        f"p{m}": Statement("Fig. 2", f"At {f:.2f} Hz p1 goes over into p{m}.", f"p{m}", "transitions")
        for f, m in PERIODS.items()
    }
    | _points(_AFTER)
)
"""What the letter says, in its order; a study that judges a point calls `run.verdict` with its key."""
