"""The keys of a scene: each with default, unit, provenance and meaning, and no other list of them.

A section is a frozen dataclass of plain values. The type of a key is that of its default: `float` (a finite
number), `int` (a whole number), `str` (one line), `tuple` (a list of finite numbers). Whether a value makes
sense is for the constructors of `beam` and `contact` to say, from which `studies.shell.scene` builds spring,
law and drive; what no constructor sees (counts, places along the strip, scans) has its limits here.

The tables of [[stops]] have the keys of `FurtherStopKeys`; any number of them is a scene.
"""

from __future__ import annotations

from dataclasses import dataclass

from studies.shell.scene.key import CALIBRATED, LETTER, OPEN, key

MODE_LISTS = ("frequencies_hz", "decay_rates_per_s", "tip_values", "participation")
"""The usual lists of [modal_data], one entry a mode."""

SHAPES = ("flat_u", "folded_u", "cantilever", "straight_strip", "modal_data")
RESPONSES = ("displacement", "velocity", "acceleration")
QUANTITIES = ("displacement", "rotation")
SUPPORTS = ("clamped", "pinned", "guided", "free")
RULES = ("strips", "constant_ratio", "constant_loss_factor", "rayleigh", "measured")
LAWS = ("linear", "newton", "hertz", "hunt_crossley", "tsuji")
FINEST = 2000  # elements of a leg or a bend: a slip of the pen must not fill the memory


@dataclass(frozen=True, kw_only=True)
class SpringKeys:
    """The leaf spring: a brass strip, with or without a glued damping tape."""

    kind: str = key(
        "flat_u", "", "shape of the spring, or modal_data for modes that were measured", choices=SHAPES
    )
    leg_length_m: float = key(0.13, "m", "length of one leg, or of a straight strip", LETTER, low=0.0)
    bend_radius_m: float = key(0.009, "m", "radius of the bend of a U, to its middle line", low=0.0)
    width_m: float = key(0.012, "m", "width of the strip, or of one leg of a flat_u")
    thickness_m: float = key(0.0011760560469233, "m", "thickness of the sheet", CALIBRATED, low=1e-9)
    young_modulus_pa: float = key(105e9, "Pa", "Young's modulus of the sheet", low=1.0)
    poisson_ratio: float = key(0.34, "1", "Poisson's ratio of the sheet")
    density_kg_m3: float = key(8500.0, "kg/m^3", "density of the sheet")
    loss_factor: float = key(1e-3, "1", "loss factor of the sheet")
    tape_thickness_m: float = key(0.00045, "m", "thickness of the damping tape; 0 for none")
    tape_sides: int = key(2, "1", "faces of the strip that carry the tape", low=1, high=2)
    tape_coverage: float = key(
        1.0, "1", "part of a leg or straight strip that the tape covers from its start", low=1e-6, high=1.0
    )
    tape_modulus_pa: float = key(1e9, "Pa", "Young's modulus of the tape")
    tape_poisson_ratio: float = key(0.40, "1", "Poisson's ratio of the tape")
    tape_density_kg_m3: float = key(1400.0, "kg/m^3", "density of the tape")
    tape_loss_factor: float = key(0.53907109242132, "1", "loss factor of the tape", CALIBRATED)
    elements_per_leg: int = key(
        0, "1", "elements on a leg or straight strip; 0: 60 on each folded leg, else 120", low=0, high=FINEST
    )
    elements_on_arc: int = key(0, "1", "elements on the bend of a folded_u; 0: 48", low=0, high=FINEST)
    start_support: str = key("clamped", "", "support at the start of a straight strip", choices=SUPPORTS)
    end_support: str = key("free", "", "support at the end of a straight strip", choices=SUPPORTS)


@dataclass(frozen=True, kw_only=True)
class TipKeys:
    """The ceramic ball with its mount, and the steel plate that it hits."""

    mass_kg: float = key(0.0068341900547184, "kg", "ball and mount", CALIBRATED)
    rotary_inertia_kg_m2: float = key(0.0, "kg m^2", "rotary inertia of ball and mount")
    arc_fraction: float = key(
        1.0, "1", "place of the tip on a straight_strip: 0 first end, 1 last end", low=0.0, high=1.0
    )
    ball_radius_m: float = key(0.0025, "m", "radius of the ball")
    ball_young_modulus_pa: float = key(370e9, "Pa", "Young's modulus of the ball")
    ball_poisson_ratio: float = key(0.22, "1", "Poisson's ratio of the ball")
    plate_young_modulus_pa: float = key(210e9, "Pa", "Young's modulus of the plate")
    plate_poisson_ratio: float = key(0.29, "1", "Poisson's ratio of the plate")


@dataclass(frozen=True, kw_only=True)
class ReadoutKeys:
    """Where the laser beam meets the spring."""

    arc_fraction: float = key(0.4, "1", "place along the strip: 0 first end, 1 last end", low=0.0, high=1.0)
    quantity: str = key(
        "displacement",
        "",
        "displacement along the drive (m) or rotation of the strip (rad)",
        choices=QUANTITIES,
    )


@dataclass(frozen=True, kw_only=True)
class DampingKeys:
    """Decay of the modes; c in q'' + c q' + omega^2 q, so that amplitudes fall as exp(-c t/2)."""

    kind: str = key(
        "strips", "", "how the modes decay; of no effect with spring.kind modal_data", choices=RULES
    )
    decay_rate_per_s: float = key(
        3.56, "1/s", "strips: c of mode 1 (printed with Fig. 5), others in proportion", LETTER
    )
    ratio: float = key(0.0116, "1", "constant_ratio: c/(2 omega) of every mode", low=0.0)
    loss_factor: float = key(0.0231, "1", "constant_loss_factor: c/omega of every mode", low=0.0)
    rayleigh_alpha_per_s: float = key(3.56, "1/s", "rayleigh: alpha in c = alpha + beta omega^2", low=0.0)
    rayleigh_beta_s: float = key(0.0, "s", "rayleigh: beta in c = alpha + beta omega^2", low=0.0)
    measured_rates_per_s: tuple[float, ...] = key((), "1/s", "measured: c of each mode kept", low=0.0)


@dataclass(frozen=True, kw_only=True)
class ModesKeys:
    """Truncation of the modal series."""

    count: int = key(0, "1", "modes kept (of modal_data: at most); 0: what the study needs", low=0, high=500)


@dataclass(frozen=True, kw_only=True)
class ModalDataKeys:
    """Mass-normalised modes of a structure of your own, for spring.kind modal_data: lists, or a CSV file."""

    file: str = key("", "", "CSV file headed by the names of the lists, relative to the scene")
    frequencies_hz: tuple[float, ...] = key((), "Hz", "undamped natural frequencies")
    decay_rates_per_s: tuple[float, ...] = key((), "1/s", "c of each mode")
    damping_ratios: tuple[float, ...] = key(
        (), "1", "c/(2 omega) of each mode, in place of decay_rates_per_s", low=0.0, high=1.0
    )
    tip_values: tuple[float, ...] = key((), "kg^(-1/2)", "shape of each mode at the tip")
    participation: tuple[float, ...] = key((), "kg^(1/2)", "participation in base motion")
    response: str = key("displacement", "", "response of the tip in the residues", choices=RESPONSES)
    force_residues_re: tuple[float, ...] = key(
        (), "", "residues over a force on the tip, m/(N s) of a displacement: real part"
    )
    force_residues_im: tuple[float, ...] = key((), "", "their imaginary part")
    base_residues_re: tuple[float, ...] = key(
        (), "", "residues over the acceleration of the base, s of a displacement: real part"
    )
    base_residues_im: tuple[float, ...] = key((), "", "their imaginary part")
    tip_mass_kg: float = key(0.0, "kg", "mass at the tip; 0 if not known", low=0.0)
    static_compliance_m_per_n: float = key(
        0.0, "m/N", "static compliance at the tip; 0: of these modes", low=0.0
    )
    dimensionless: bool = key(False, "", "whether lengths, masses and times are in units of your own")
    kappa: float = key(0.0, "1", "relative rise of the free frequency, times (kappa_length/A)^2; 0: linear")
    kappa_length_m: float = key(1.0, "m", "the length that kappa counts amplitudes in")


@dataclass(frozen=True, kw_only=True)
class SingleModeKeys:
    """Eq. (1) of the letter, and the map; -1 leaves a value open, to be taken from the spring."""

    free_period_s: float = key(
        OPEN, "s", "damped period T of the free motion; -1: that of mode 1", printed=0.0408
    )
    decay_rate_per_s: float = key(OPEN, "1/s", "decay rate mu; -1: that of mode 1", printed=3.56)
    restitution: float = key(
        OPEN, "1", "tau; -1: that of a first collision of the beam at excess 0.013", printed=0.1
    )


@dataclass(frozen=True, kw_only=True)
class DriveKeys:
    """Motion of the base."""

    kind: str = key(
        "harmonic", "", "harmonic motion of the base, or a base at rest", LETTER, choices=("harmonic", "none")
    )
    frequencies_hz: tuple[float, ...] = key(
        (20.90, 21.50, 22.20, 22.60, 23.05, 23.40), "Hz", "drive frequencies", LETTER
    )


@dataclass(frozen=True, kw_only=True)
class StopKeys:
    """The plate, fixed to the base; [[stops]] with gap_m, side, at and keys of [contact] adds another."""

    gap_m: float = key(0.011883925614219, "m", "from the ball at rest to the plate", CALIBRATED, low=0.0)


@dataclass(frozen=True, kw_only=True)
class ContactKeys:
    """Ball on plate."""

    law: str = key("hertz", "", "what happens at the plate", choices=LAWS)
    stiffness_n_per_m: float = key(
        0.0, "N/m", "linear: stiffness; 0: that with Hertz's contact time", low=0.0
    )
    damping_ns_per_m: float = key(0.0, "N s/m", "linear: dashpot beside it", low=0.0)
    local_restitution: float = key(1.0, "1", "newton, tsuji: speed after over before", low=0.0, high=1.0)
    dissipation_s_per_m: float = key(
        0.0, "s/m", "hunt_crossley: chi in N = k d^(3/2) (1 + chi d'), k that of hertz", low=0.0
    )


@dataclass(frozen=True, kw_only=True)
class FurtherStopKeys(ContactKeys, StopKeys):
    """A further stop, fixed to the base."""

    gap_m: float = key(StopKeys.gap_m, "m", "from the point at rest to the stop", low=1e-12)
    law: str = key(
        "contact", "", "what happens at this stop; contact: as [contact] says", choices=("contact", *LAWS)
    )
    side: int = key(-1, "1", "1: beside the plate of [stop]; -1: on the other side", low=-1, high=1)
    at: str = key("tip", "", "point of the spring that reaches it", choices=("tip", "readout"))


@dataclass(frozen=True, kw_only=True)
class ScanKeys:
    """Slow scans of the drive amplitude through grazing; excess is amplitude/grazing amplitude - 1."""

    reach_below: float = key(2.0, "1", "lower end of a scan, in hystereses below grazing", low=1e-9)
    reach_above: float = key(3.0, "1", "upper end of a scan, in hystereses above grazing", low=1e-9)
    narrowest: float = key(5e-4, "1", "least hysteresis for the ends of a scan", low=1e-12)
    points: int = key(61, "1", "amplitudes in a scan", low=2, high=1e6)
    settle_cycles: int = key(
        1000, "1", "drive periods left out at each amplitude (letter: 10000)", low=0, high=1e7
    )
    record_cycles: int = key(40, "1", "strobe points kept at each amplitude", LETTER, low=1, high=1e6)
    born_excess: float = key(1e-3, "1", "excess at which the born period is read", low=1e-12)
    largest_period: int = key(64, "1", "longest period looked for", low=1, high=10_000)
