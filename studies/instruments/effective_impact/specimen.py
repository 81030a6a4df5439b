"""A spring whose modes are made once and then meet the plate under many contact laws."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from beam import ModalModel
from contact.laws import ContactLaw, HertzContact, HuntCrossley, LinearContact
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from studies.instruments.oscillators import approach_speed, beam_of, hertz_of
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.tip_mass_family import leaf_mass

__all__ = ["Specimen"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Specimen:
    """A spring with its modes, made once and used in many cells."""

    scene: Scene
    model: ModalModel
    frequency: float
    mass_ratio: float

    @staticmethod
    def of(scene: Scene, frequency: float, modes: int) -> Specimen:
        """The spring of a scene with this many modes."""
        model = model_of(scene.replace({"modes.count": modes}))
        return Specimen(
            scene=scene, model=model, frequency=frequency, mass_ratio=scene.tip.mass_kg / leaf_mass(scene)
        )

    @property
    def hertz(self) -> HertzContact:
        return hertz_of(self.scene)

    @property
    def tip_stiffness(self) -> float:
        """Static stiffness of the spring at its tip [N/m]."""
        return 1.0 / float(self.model.static_compliance or math.nan)

    def speed(self, excess: float) -> float:
        """Approach speed [m/s]."""
        return approach_speed(self.frequency, self.scene.stop.gap_m, excess)

    def with_law(
        self, law: ContactLaw, model: ModalModel | None = None, frequency: float = 0.0
    ) -> ImpactOscillator:
        """The oscillator with this contact law, and another model or drive frequency [Hz] if given."""
        hertz = self.scene.replace({"contact.law": "hertz"})
        oscillator = beam_of(hertz, frequency or self.frequency, self.model if model is None else model)
        return replace(oscillator, stop=Stop(gap=self.scene.stop.gap_m, law=law))

    def lossy(self, restitution: float, excess: float) -> HuntCrossley:
        """Hunt-Crossley's law with this restitution of a free mass at the approach speed of `excess`."""
        return HuntCrossley.with_restitution(
            stiffness=self.hertz.stiffness, restitution=restitution, velocity=self.speed(excess)
        )

    def as_hard_as(self, factor: float, excess: float) -> LinearContact:
        """Linear contact, `factor` times as stiff as the one with the contact time of Hertz's law."""
        mass = self.scene.tip.mass_kg
        contact = self.hertz.contact_time(mass, self.speed(excess))
        return LinearContact(stiffness=factor * mass * (math.pi / contact) ** 2)
