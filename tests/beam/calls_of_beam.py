"""Public calls of `beam`: right arguments and wrong values of each, and how such a table is written.

    of(call, right arguments, kind=dict(field=value), value=dict(field=each(value, value)))

`kind` holds values of a wrong kind (TypeError), `value` holds values out of range, not finite or of a wrong
shape (ValueError).  The message names the field and the value; where it names others, `says` has the words.
`test_wrong_input.py` makes the calls.  With `over`, the right arguments are a function of a case, and
`contact/test_bounded_calls.py` makes the call for every law of contact too.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import beam

NAN, INF = math.nan, math.inf


class each(tuple[Any, ...]):
    """Several wrong values of one field."""

    def __new__(cls, *values: object) -> each:
        return super().__new__(cls, values)


@dataclasses.dataclass(frozen=True)
class says:
    """A wrong value and the words of the sentence about it."""

    value: object
    words: str


@dataclasses.dataclass(frozen=True)
class Entry:
    """A public call: its right arguments, and (field, wrong value, type of the error)."""

    name: str
    call: Callable[..., Any]
    arguments: Callable[..., dict[str, Any]]
    """A function of a case, or of nothing where `over` is empty."""
    wrong: tuple[tuple[str, Any, type[Exception]], ...]
    over: str
    """Over which cases of an oscillator the call is made, see `contact/cases_of_calls.py`."""

    def right(self, usual: Any) -> dict[str, Any]:
        """The arguments of a right call, in the case `usual` if it has cases."""
        return self.arguments(usual) if self.over else self.arguments()

    @property
    def public_name(self) -> str:
        """The name of the function, class or method that is called."""
        return self.name.partition(",")[0]


def of(
    call: Callable[..., Any],
    right: Any,
    name: str = "",
    *,
    over: str = "",
    kind: Any = None,
    value: Any = None,
) -> Entry:
    """An entry of a table; a function gives the right arguments where they take time to make."""
    wrong = []
    for error, fields in ((TypeError, kind or {}), (ValueError, value or {})):
        for field, values in fields.items():
            wrong += [(field, one, error) for one in (values if isinstance(values, each) else [values])]
    arguments = right if callable(right) else lambda: dict(right)
    return Entry(name or call.__qualname__, call, arguments, tuple(wrong), over)


def fields_of(instance: Any) -> dict[str, Any]:
    """The arguments that make this instance of a dataclass."""
    return {entry.name: getattr(instance, entry.name) for entry in dataclasses.fields(instance)}


@cache
def strip() -> beam.StripSection:
    return beam.StripSection(material=beam.BRASS, width=0.012, thickness=0.00065)


@cache
def spring() -> beam.LeafSpring:
    return beam.folded_u(leg_length=0.13, bend_radius=0.0075, section=strip(), tip=beam.Tip(mass=0.004))


@cache
def mesh() -> beam.Discretization:
    return beam.assemble(spring(), 4)


@cache
def modes() -> beam.Modes:
    return beam.natural_modes(mesh(), 6)


@cache
def one_mode() -> beam.ModalModel:
    return beam.single_mode(free_period=0.04, decay_rate=3.0)


@cache
def uniform() -> beam.UniformBeam:
    return beam.UniformBeam(length=0.13, bending_stiffness=0.03, mass_per_length=0.07)


MODAL = dict(omega=[150.0, 900.0], decay_rate=[3.0, 9.0], phi=[10.0, 9.0], participation=[0.1, 0.05])

# fmt: off
BEAM = (
    of(beam.Material, dict(youngs_modulus=105e9, poissons_ratio=0.34, density=8500.0, loss_factor=1e-3),
       kind=dict(density="8500"), value=dict(youngs_modulus=-1.0, poissons_ratio=0.5, loss_factor=-1e-3)),
    of(beam.StripSection, dict(material=beam.BRASS, width=0.012, thickness=0.00065),
       kind=dict(material="brass", layer=0.00045), value=dict(width=0.0, thickness=0.65, slot=-0.003)),
    of(beam.BeamSection, dict(bending_stiffness=2.0, mass_per_length=0.1, thickness=0.01, width=0.02),
       kind=dict(thickness="1 cm", axial_stiffness="hard"),
       value=dict(mass_per_length=0.0, width=-0.01, loss_factor=-1.0, axial_stiffness=-1.0)),
    of(beam.BeamSection.tube, dict(material=beam.STEEL, outer=0.01, inner=0.008), name="BeamSection, tube",
       kind=dict(material="steel"), value=dict(outer=0.0, inner=each(0.01, -0.001))),
    of(beam.Layer, dict(material=beam.DAMPING_TAPE, thickness=0.00045),
       kind=dict(material=None, both_sides=2), value=dict(thickness=-0.00045)),
    of(beam.Straight, dict(length=0.13),
       kind=dict(length="0.13"), value=dict(length=each(-0.13, NAN))),
    of(beam.Arc, dict(radius=0.0075, angle=math.pi),
       kind=dict(angle="pi"), value=dict(radius=0.0, angle=0.0)),
    of(beam.Centreline, dict(pieces=(beam.Straight(length=0.1),), start=(0.0, 0.0), heading=0.0),
       kind=dict(pieces=each(3, (0.1,)), start=("a", "b"), heading="east"),
       value=dict(pieces=says((), "is empty"), start=(0.0,))),
    of(beam.Centreline(pieces=(beam.Straight(length=0.1),)).points, dict(s=[0.05]), name="Centreline, points",
       kind=dict(s="end"), value=dict(s=each(0.2, [NAN]))),
    of(beam.Tip, dict(mass=0.004, rotary_inertia=0.0),
       kind=dict(mass="4 g"), value=dict(mass=-0.004, rotary_inertia=NAN)),
    of(beam.Readout, dict(at=0.05),
       kind=dict(at="middle"), value=dict(at=-0.05, quantity="velocity")),
    of(beam.LeafSpring, lambda: fields_of(spring()),
       kind=dict(centreline=0.28, sections=3, tip=0.004, drive=("x", "y"), readouts={"laser": 0.1},
                 points=each(0.1, says({"leg": "middle"}, "points['leg'] is 'middle'"),
                             says({"leg": (0.0, None)}, "point is (0.0, None)")),
                 between=each(0.1, says({"middle": "pinned"}, "between is 'middle'"))),
       value=dict(sections=(), supports=each("clamped", ("clamped", ["free"])), tip_at=each(1.0, 0.0),
                  points=each(says({"tip": 0.1}, "has the name of the tip"),
                              says({"leg": 9.0}, "points['leg']"),
                              says({"leg": (0.05, 0.05)}, "m from the centreline"),
                              says({"leg": 0.0}, "where the strip is clamped")),
                  between=each(says({0.0: "pinned"}, "between is 0.0 m"), says({0.1: "glued"}, "supports is"),
                               says({spring().tip_at: "pinned"}, "where the strip is pinned")),
                  drive=(0.0, 0.0))),
    of(beam.folded_u,
       lambda: dict(leg_length=0.13, bend_radius=0.0075, section=strip(), tip=beam.Tip(mass=0.004)),
       kind=dict(bend_radius=says("tight", "radius is 'tight'"), tip=None, damped_section=0.45e-3,
                 section=says(beam.BRASS, "sections is Material")),
       value=dict(leg_length=says(0.0, "length of the straight strip or leg is 0.0 m"),
                  bend_radius=says(0.0003, "radius is 0.0003 m"), damped_span=(0.0, 0.1))),
    of(beam.flat_u,
       lambda: dict(leg_length=0.13, bend_radius=0.0075, section=strip(), tip=beam.Tip(mass=0.004)),
       kind=dict(bend_radius="tight", tip=None, damped_section=0.45e-3, section=beam.BRASS),
       value=dict(leg_length=says(0.0, "length of the straight strip or leg is 0.0 m"),
                  bend_radius=each(0.006, NAN), damped_span=(0.0, 0.1))),
    of(beam.straight_strip,
       lambda: dict(length=0.13, section=strip(), supports=("clamped", "free"), tip_at=0.13),
       value=dict(length=-1.0, tip_at=130.0, supports=("glued", "free"))),
    of(beam.straight_strip, lambda: dict(length=0.13, section=strip(), supports=("clamped", "free"),
                                         tip_at=0.13, damped_section=strip(), damped_span=(0.05, 0.1)),
       name="straight_strip, damped",
       kind=dict(damped_span=(0.0, "end")), value=dict(damped_span=(0.1, 0.05))),
    of(beam.cantilever, lambda: dict(length=0.13, section=strip()),
       kind=dict(section=says(None, "sections is None"), tip=0.004, readouts=[0.1]),
       value=dict(length=0, readouts=says({"far": beam.Readout(at=0.2)}, "readouts['far'] is 0.2 m"))),
    of(beam.assemble, lambda: dict(spring=spring(), elements=4),
       kind=dict(spring=strip()), value=dict(elements=each(0, [4, 4], [4, 2.5, 4], 10**9))),
    of(beam.default_elements, lambda: dict(spring=spring()),
       kind=dict(spring=each(None, 3, "folded_u"))),
    of(beam.backbone_coefficient, lambda: dict(spring=spring(), elements=4),
       kind=dict(spring=each(None, strip())),
       value=dict(elements=0, spring=says(
           beam.straight_strip(length=0.1, section=strip(), supports=("free", "free"), tip_at=0.1),
           "supports leave 2 motions without strain"))),
    of(beam.periodic_motion, lambda: dict(model=beam.FiniteRotation.of(spring(), 2), amplitude=1e-3,
                                          frequency=22.2, decay_rate=3.56, harmonics=1),
       kind=dict(model=spring(), frequency="22 Hz"),
       value=dict(amplitude=each(NAN, 0.0), frequency=0.0, decay_rate=-1.0, harmonics=0)),
    of(beam.Discretization, lambda: fields_of(mesh()),
       kind=dict(spring=None),
       value=dict(tip=[NAN], mass=np.eye(2), stiffness=says(3.0, "stiffness has shape None"))),
    of(beam.natural_modes, lambda: dict(discretization=mesh(), count=4),
       kind=dict(discretization=spring()), value=dict(count=each(0, 10**6, 2.5))),
    of(beam.Modes, lambda: fields_of(modes()),
       kind=dict(discretization=None, participation=["a"] * 6), value=dict(omega=[[1.0]], phi=[1.0])),
    of(lambda points_per_element: modes().displacement_along(points_per_element), dict(points_per_element=4),
       name="Modes, displacement_along", value=dict(points_per_element=0)),
    of(lambda modes: beam.StripDamping().decay_rates(modes), lambda: dict(modes=modes()), name="StripDamping",
       kind=dict(modes=each(None, [24.5, 149.0], "all"))),
    of(beam.ConstantLossFactor, dict(loss_factor=0.02),
       kind=dict(loss_factor="2 %"), value=dict(loss_factor=each(-0.02, NAN))),
    of(beam.ConstantRatio, dict(ratio=0.0116),
       kind=dict(ratio=[0.01]), value=dict(ratio=each(-0.1, INF))),
    of(beam.Rayleigh, dict(mass_coefficient=3.56, stiffness_coefficient=1e-6),
       kind=dict(stiffness_coefficient=None), value=dict(mass_coefficient=-1.0, stiffness_coefficient=NAN)),
    of(beam.MeasuredDecay, dict(decay_rate=3.56),
       kind=dict(others=each("strips", beam.StripDamping), scaled=1), value=dict(decay_rate=-3.56)),
    of(beam.reduce, lambda: dict(modes=modes(), damping=beam.ConstantRatio(ratio=0.01), count=2),
       kind=dict(modes=mesh(), damping=0.01), value=dict(count=each(0, 50))),
    of(beam.Point, dict(row=[10.0, 9.0], static_compliance=1e-3, mass=0.004),
       kind=dict(row="10"), value=dict(row=[], static_compliance=-1e-3)),
    of(beam.ModalModel, MODAL | dict(static_compliance=1e-3, tip_mass=0.004),
       kind=dict(omega=each("150", [150.0, 1j], [True, False]), points=each([1.0], {"tip": [10.0, 9.0]}),
                 dimensionless=each(1, "yes", None)),
       value=dict(omega=[], decay_rate=[-3.0, 9.0], phi=[10.0], participation=[NAN, 1.0], tip_mass=-1.0,
                  points=says({"laser": beam.Point(row=[1.0])}, "points['laser'] has shape (1,)"))),
    of(beam.ModalModel.from_matrices,
       dict(M=np.eye(2), K=[[2.0, -1.0], [-1.0, 2.0]], points={"a": [1.0, 0.0]}, base=[1.0, 1.0], modes=2,
            C=[[0.4, -0.2], [-0.2, 0.4]]),
       kind=dict(M="heavy", points=each([1.0, 0.0], {"a": "end"}), base="up"),
       value=dict(M=each(says(-np.eye(2), "M is not positive"), says(np.eye(3), "M, 3 unknowns")),
                  K=each(says([[1.0, 0.5], [0.0, 1.0]], "K has entries 0.5"), says(-np.eye(2), "K and M"),
                         says([[NAN, 0.0], [0.0, 1.0]], "K holds nan")),
                  points=each(says({}, "points is empty"), says({"a": [0, 0]}, "['a'] is moved by none"),
                              says({"a": [1.0]}, "['a'] has shape (1,)")),
                  base=[1.0], modes=each(0, 3), C=says([[0.0, 0.0], [0.0, 0.4]], "C couples the modes"))),
    of(beam.ModalModel.from_residues,
       dict(poles=[-1 + 150j, -9 + 900j], force_residues=[-0.3j, -0.04j], base_residues=[0.003j, -1e-4j]),
       kind=dict(poles=each("150", [True, False]), force_residues=each(None, [[1], [2, 3]]), response=2),
       value=dict(poles=each(says([-1 - 150j, 9j], "poles holds -1-150j rad/s in mode 1"),
                             [150.0, 900.0], []),
                  force_residues=each(says([0, -0.04j], "force_residues is 0 in mode 1"), [-0.3j], [NAN, -1j],
                                      says([-0.3j, 0.04j], "phase in mode 2 that is 180 degrees off")),
                  base_residues=says([0.003, 0], "phase in mode 1 that is -90 degrees off"),
                  response="force")),
    of(lambda count: beam.ModalModel(**MODAL).truncated(count), dict(count=2), name="ModalModel, truncated",
       value=dict(count=each(0, 3))),
    of(beam.ModalModel(**MODAL).load_of, dict(forces={"tip": 0.1}), name="ModalModel, load_of",
       kind=dict(forces=each(0.1, says({"tip": "soft"}, "forces['tip'] is 'soft'"))),
       value=dict(forces=each(says({"nose": 0.1}, "forces names 'nose'"),
                              says({"tip": NAN}, "forces['tip']")))),
    of(lambda **statics: beam.ModalModel(**MODAL, **statics).with_residual_mode(),
       dict(static_compliance=1e-2, tip_mass=0.004), name="ModalModel, with_residual_mode",
       value=dict(tip_mass=0.0, static_compliance=each(None, says(4.5e-3, "must be above zero and above")))),
    of(lambda phi: dataclasses.replace(
           beam.ModalModel(**MODAL, static_compliance=1e-2, tip_mass=0.004), phi=phi),  # type: ignore[arg-type]
       dict(phi=[-10.0, 9.0]), name="ModalModel, at another point",
       value=dict(phi=says([5.0, -3.0], "static_compliance is 0.01 m/N, which belongs to"))),
    of(beam.single_mode, dict(free_period=40.8e-3, decay_rate=3.56),
       kind=dict(free_period="40.8 ms"), value=dict(free_period=0.0, decay_rate=-3.56)),
    of(beam.ModalChange, lambda: dict(MODAL),
       value=dict(omega=each([[1.0]], [NAN, 1.0]), phi=each([1.0], [INF, 1.0]))),
    of(beam.free_period_change, lambda: dict(model=one_mode()), kind=dict(model=each(5, "no", None))),
    of(beam.decay_rate_change, lambda: dict(model=one_mode(), mode=0), kind=dict(model="no"),
       value=dict(mode=each(1, -1))),
    of(beam.tip_mass_change, lambda: dict(model=beam.ModalModel(**MODAL)), kind=dict(model=each("no", None)),
       value=dict(model=says(beam.ModalModel(**MODAL | dict(omega=[9.0, 9.0])), "omega is [9. 9.] rad/s; "))),
    of(beam.with_tip_mass, lambda: dict(model=beam.ModalModel(**MODAL, tip_mass=0.004), mass=0.003),
       kind=dict(model="no", mass="3 g"),
       value=dict(model=says(one_mode(), "tip_mass is None kg"), mass=each(-1.0, 0.0))),
    of(lambda mass: beam.with_tip_mass(
           beam.ModalModel(**MODAL | dict(phi=[10.0, 19.0]), tip_mass=0.004), mass),  # type: ignore[arg-type]
       dict(mass=0.004), name="with_tip_mass, of modes that need more", value=dict(mass=1e-4)),
    of(beam.UniformBeam, lambda: fields_of(uniform()),
       value=dict(length=0.0, bending_stiffness=NAN, supports=each(("clamped",), 2))),
    of(beam.UniformBeam, lambda: fields_of(uniform()) | dict(supports=("free", "clamped")),
       name="UniformBeam, clamped at its tip", value=dict(tip_mass=1.0)),
    of(beam.exact_modes, lambda: dict(beam=uniform(), count=2),
       kind=dict(beam=spring()), value=dict(count=each(0, 10**7))),
)
# fmt: on
