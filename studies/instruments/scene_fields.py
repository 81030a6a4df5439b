"""The keys of a scene: one line each, and no other list of them anywhere.

Adding a key is adding a line here. `letter` marks what the letter prints, `calibrated` what was fitted to a
number it prints (thickness to the free period, loss factor of the tape to the decay rate, ball mass and gap
to the impacts and the drive amplitude), `assumed` everything else. Names end in their unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from studies.instruments.quantities import (
    ANY,
    ASSUMED,
    CALIBRATED,
    FRACTION,
    LETTER,
    NOT_NEGATIVE,
    POISSON,
    POSITIVE,
    Interval,
    Key,
    Section,
    one_of,
    whole,
)

SUPPORTS = one_of("clamped", "pinned", "guided", "free")


@dataclass(frozen=True, kw_only=True)
class SpringKeys(Section):
    """The leaf spring: a brass strip, with or without a glued damping tape."""

    section: ClassVar[str] = "spring"
    kind: Annotated[str, Key(
        "", ASSUMED, "shape of the spring, or modal_data for modes that were measured",
        one_of("folded_u", "cantilever", "straight_strip", "modal_data"))] = "folded_u"
    leg_length_m: Annotated[float, Key(
        "m", LETTER, "length of one leg; of the whole strip if straight", POSITIVE)] = 0.13
    bend_radius_m: Annotated[float, Key(
        "m", ASSUMED, "radius of the bend of the folded strip", POSITIVE)] = 0.0075
    width_m: Annotated[float, Key(
        "m", ASSUMED, "width of the strip", POSITIVE)] = 0.012
    thickness_m: Annotated[float, Key(
        "m", CALIBRATED, "thickness of the sheet, from the free period", POSITIVE)] = 0.00069683709067
    young_modulus_pa: Annotated[float, Key(
        "Pa", ASSUMED, "Young's modulus of the sheet (brass)", POSITIVE)] = 105e9
    poisson_ratio: Annotated[float, Key(
        "1", ASSUMED, "Poisson's ratio of the sheet (brass)", POISSON)] = 0.34
    density_kg_m3: Annotated[float, Key(
        "kg/m^3", ASSUMED, "density of the sheet (brass)", POSITIVE)] = 8500.0
    loss_factor: Annotated[float, Key(
        "1", ASSUMED, "loss factor of the sheet (brass)", NOT_NEGATIVE)] = 1e-3
    tape_thickness_m: Annotated[float, Key(
        "m", ASSUMED, "thickness of the damping tape; 0 for none", NOT_NEGATIVE)] = 0.00045
    tape_sides: Annotated[int, Key(
        "1", ASSUMED, "faces of the strip that carry the tape", whole(1, 2))] = 1
    tape_coverage: Annotated[float, Key(
        "1", ASSUMED, "part of each leg, or of a straight strip, that the tape covers from its start; the "
        "bend is bare", Interval(0.0, 1.0, low_open=True))] = 1.0
    tape_modulus_pa: Annotated[float, Key(
        "Pa", ASSUMED, "Young's modulus of the tape", POSITIVE)] = 1e9
    tape_poisson_ratio: Annotated[float, Key(
        "1", ASSUMED, "Poisson's ratio of the tape", POISSON)] = 0.40
    tape_density_kg_m3: Annotated[float, Key(
        "kg/m^3", ASSUMED, "density of the tape", POSITIVE)] = 1400.0
    tape_loss_factor: Annotated[float, Key(
        "1", CALIBRATED, "loss factor of the tape, from the decay of mode 1", NOT_NEGATIVE)] = 0.49481929798
    elements_per_leg: Annotated[int, Key(
        "1", ASSUMED, "elements on a leg, or on a straight strip; 0 for the default, 60 on each of two legs "
        "or 120 on a straight strip", whole(0, 2000))] = 0
    elements_on_arc: Annotated[int, Key(
        "1", ASSUMED, "elements on the bend; 0 for the default, 48", whole(0, 2000))] = 0
    start_support: Annotated[str, Key(
        "", ASSUMED, "support at the start of a straight strip", SUPPORTS)] = "clamped"
    end_support: Annotated[str, Key(
        "", ASSUMED, "support at the end of a straight strip", SUPPORTS)] = "free"


@dataclass(frozen=True, kw_only=True)
class TipKeys(Section):
    """The ceramic ball with its mount, and the steel plate that it hits."""

    section: ClassVar[str] = "tip"
    mass_kg: Annotated[float, Key(
        "kg", CALIBRATED, "ball and mount, so that mode 1 is stopped (kick 1)",
        NOT_NEGATIVE)] = 0.006161452904
    rotary_inertia_kg_m2: Annotated[float, Key(
        "kg m^2", ASSUMED, "rotary inertia of ball and mount", NOT_NEGATIVE)] = 0.0
    arc_fraction: Annotated[float, Key(
        "1", ASSUMED, "place of the tip on a straight_strip: 0 first end, 1 last end; the other kinds have "
        "theirs", FRACTION)] = 1.0
    ball_radius_m: Annotated[float, Key(
        "m", ASSUMED, "radius of the ball", POSITIVE)] = 0.0025
    ball_young_modulus_pa: Annotated[float, Key(
        "Pa", ASSUMED, "Young's modulus of the ball (alumina)", POSITIVE)] = 370e9
    ball_poisson_ratio: Annotated[float, Key(
        "1", ASSUMED, "Poisson's ratio of the ball (alumina)", POISSON)] = 0.22
    plate_young_modulus_pa: Annotated[float, Key(
        "Pa", ASSUMED, "Young's modulus of the plate (steel)", POSITIVE)] = 210e9
    plate_poisson_ratio: Annotated[float, Key(
        "1", ASSUMED, "Poisson's ratio of the plate (steel)", POISSON)] = 0.29


@dataclass(frozen=True, kw_only=True)
class ReadoutKeys(Section):
    """Where the laser beam meets the spring."""

    section: ClassVar[str] = "readout"
    arc_fraction: Annotated[float, Key(
        "1", ASSUMED, "place along the strip: 0 first end, 1 last end; the ball of a folded strip sits "
        "at 0.5", FRACTION)] = 0.4
    quantity: Annotated[str, Key(
        "", ASSUMED, "what is read there: displacement along the drive (m) or rotation of the strip (rad)",
        one_of("displacement", "rotation"))] = "displacement"


@dataclass(frozen=True, kw_only=True)
class DampingKeys(Section):
    """Decay of the modes; c in q'' + c q' + omega^2 q, so that amplitudes fall as exp(-c t/2)."""

    section: ClassVar[str] = "damping"
    kind: Annotated[str, Key(
        "", ASSUMED, "how the modes decay; of no effect with spring.kind modal_data",
        one_of("strips", "constant_ratio", "constant_loss_factor", "rayleigh", "measured"))] = "strips"
    decay_rate_per_s: Annotated[float, Key(
        "1/s", LETTER, "strips: c of mode 1 (printed with Fig. 5); that of the others follows in proportion",
        NOT_NEGATIVE)] = 3.56
    ratio: Annotated[float, Key(
        "1", ASSUMED, "constant_ratio: c/(2 omega) of every mode", NOT_NEGATIVE)] = 0.0116
    loss_factor: Annotated[float, Key(
        "1", ASSUMED, "constant_loss_factor: c/omega of every mode", NOT_NEGATIVE)] = 0.0231
    rayleigh_alpha_per_s: Annotated[float, Key(
        "1/s", ASSUMED, "rayleigh: alpha in c = alpha + beta omega^2", NOT_NEGATIVE)] = 3.56
    rayleigh_beta_s: Annotated[float, Key(
        "s", ASSUMED, "rayleigh: beta in c = alpha + beta omega^2", NOT_NEGATIVE)] = 0.0
    measured_rates_per_s: Annotated[tuple[float, ...], Key(
        "1/s", ASSUMED, "measured: c of each mode kept", NOT_NEGATIVE, may_be_empty=True)] = ()


@dataclass(frozen=True, kw_only=True)
class ModesKeys(Section):
    """Truncation of the modal series."""

    section: ClassVar[str] = "modes"
    count: Annotated[int, Key(
        "1", ASSUMED, "modes kept (of modal_data: at most); 0: what the study needs", whole(0, 500))] = 0


@dataclass(frozen=True, kw_only=True)
class ModalDataKeys(Section):
    """Mass-normalised modes of a structure of your own, for spring.kind modal_data: lists, or a CSV file."""

    section: ClassVar[str] = "modal_data"
    file: Annotated[str, Key(
        "", ASSUMED, "CSV file with the names of the four lists as its heading; a path is relative to "
        "the scene")] = ""
    frequencies_hz: Annotated[tuple[float, ...], Key(
        "Hz", ASSUMED, "undamped natural frequencies", POSITIVE, may_be_empty=True)] = ()
    decay_rates_per_s: Annotated[tuple[float, ...], Key(
        "1/s", ASSUMED, "c of each mode", NOT_NEGATIVE, may_be_empty=True)] = ()
    tip_values: Annotated[tuple[float, ...], Key(
        "kg^(-1/2)", ASSUMED, "shape of each mode at the tip", ANY, may_be_empty=True)] = ()
    participation: Annotated[tuple[float, ...], Key(
        "kg^(1/2)", ASSUMED, "participation of each mode in a motion of the base",
        ANY, may_be_empty=True)] = ()
    tip_mass_kg: Annotated[float, Key(
        "kg", ASSUMED, "mass at the tip; 0 if not known", NOT_NEGATIVE)] = 0.0
    static_compliance_m_per_n: Annotated[float, Key(
        "m/N", ASSUMED, "static compliance at the tip; 0 for that of the modes given", NOT_NEGATIVE)] = 0.0


@dataclass(frozen=True, kw_only=True)
class SingleModeKeys(Section):
    """Eq. (1) of the letter."""

    section: ClassVar[str] = "single_mode"
    free_period_s: Annotated[float, Key(
        "s", LETTER, "damped period of the free motion", POSITIVE)] = 0.0408
    decay_rate_per_s: Annotated[float, Key(
        "1/s", LETTER, "mu (printed with Fig. 5)", NOT_NEGATIVE)] = 3.56
    restitution: Annotated[float, Key(
        "1", LETTER, "tau, about 0.1", FRACTION)] = 0.1


@dataclass(frozen=True, kw_only=True)
class DriveKeys(Section):
    """Motion of the base."""

    section: ClassVar[str] = "drive"
    kind: Annotated[str, Key(
        "", LETTER, "harmonic motion of the base, or a base at rest",
        one_of("harmonic", "none"))] = "harmonic"
    frequencies_hz: Annotated[tuple[float, ...], Key(
        "Hz", LETTER, "drive frequencies, those of Fig. 2",
        POSITIVE)] = (20.90, 21.50, 22.20, 22.60, 23.05, 23.40)


@dataclass(frozen=True, kw_only=True)
class StopKeys(Section):
    """The plate, fixed to the base."""

    section: ClassVar[str] = "stop"
    gap_m: Annotated[float, Key(
        "m", CALIBRATED, "from the ball at rest to the plate; 2 mm of drive at grazing",
        NOT_NEGATIVE)] = 0.0106993324


@dataclass(frozen=True, kw_only=True)
class ContactKeys(Section):
    """Ball on plate."""

    section: ClassVar[str] = "contact"
    law: Annotated[str, Key(
        "", ASSUMED, "what happens at the plate", one_of("linear", "newton", "hertz"))] = "hertz"
    stiffness_n_per_m: Annotated[float, Key(
        "N/m", ASSUMED, "linear: stiffness; 0 for the one that has the contact time of Hertz's law",
        NOT_NEGATIVE)] = 0.0
    damping_ns_per_m: Annotated[float, Key(
        "N s/m", ASSUMED, "linear: dashpot beside it", NOT_NEGATIVE)] = 0.0
    local_restitution: Annotated[float, Key(
        "1", ASSUMED, "newton: speed after over speed before one impact", FRACTION)] = 1.0


@dataclass(frozen=True, kw_only=True)
class ScanKeys(Section):
    """Slow scans of the drive amplitude through grazing; excess is amplitude/grazing amplitude - 1."""

    section: ClassVar[str] = "scan"
    reach_below: Annotated[float, Key(
        "1", ASSUMED, "lower end of a scan: this many times the hysteresis below grazing", POSITIVE)] = 2.0
    reach_above: Annotated[float, Key(
        "1", ASSUMED, "upper end of a scan: this many times the hysteresis above grazing", POSITIVE)] = 3.0
    narrowest: Annotated[float, Key(
        "1", ASSUMED, "hysteresis assumed for the reach of a scan where there is less", POSITIVE)] = 5e-4
    points: Annotated[int, Key(
        "1", ASSUMED, "amplitudes in a scan", whole(2, 1_000_000))] = 61
    settle_cycles: Annotated[int, Key(
        "1", ASSUMED, "drive periods left out at each amplitude (the letter waits for about 10000)",
        whole(0, 10_000_000))] = 1000
    record_cycles: Annotated[int, Key(
        "1", LETTER, "strobe points kept at each amplitude", whole(1, 1_000_000))] = 40
    born_excess: Annotated[float, Key(
        "1", ASSUMED, "excess at which the born period is read", POSITIVE)] = 1e-3
    largest_period: Annotated[int, Key(
        "1", ASSUMED, "longest period looked for, in drive periods", whole(1, 10_000))] = 64
