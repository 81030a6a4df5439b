"""The information in a record: standard errors at the truth, by the simulator alone.

    x(t) = offset + X(f t; p),   J = dx/d(p, phase, offset),   covariance = sigma^2 (J^T J)^-1,

X the settled orbit over its drive phase.  Its derivatives by the parameters p are central differences of
orbits in closed form; dx/df has t/f x'(t) besides.  A fit that also finds the state at the first row has
slightly larger errors.
"""

import contextlib

import numpy as np
from record_simulators import Beam, Record, Rejected, follow, tip

STEP = 1e-6  # relative change of a parameter or a state in a difference
MOST = {"restitution": 0.5}  # standard error above which a parameter is not determined; else its own value


def truth_of(lab: Beam) -> dict[str, float]:
    """What is fitted, with its true values."""
    period = 2.0 * np.pi / np.sqrt(lab.omega[0] ** 2 - 0.25 * lab.c[0] ** 2)
    law = "restitution" if lab.stiffness is None else "stiffness"
    truth = {"free_period": float(period), "decay_rate": float(lab.c[0])}
    return truth | {name: getattr(lab, name) for name in ("gap", "amplitude", law, "frequency")}


def changed(lab: Beam, name: str, factor: float) -> Beam:
    """The beam with one parameter times `factor`; higher modes keep their ratios to the first."""
    kept = ("omega", "c", "phi", "gamma", "gap", "frequency", "restitution", "stiffness")
    own, amplitude = {one: getattr(lab, one) for one in kept}, lab.amplitude
    if name == "amplitude":
        amplitude *= factor
    elif name in own:
        own[name] *= factor
    else:
        rate, period = (1.0, factor) if name == "free_period" else (factor, 1.0)
        damped = np.sqrt(lab.omega[0] ** 2 - 0.25 * lab.c[0] ** 2) / period
        own["omega"] = lab.omega * np.hypot(damped, 0.5 * rate * lab.c[0]) / lab.omega[0]
        own["c"] = lab.c * rate
    return Beam(**own, excess=amplitude / Beam(**own, excess=0.0).grazing_amplitude - 1.0)


def judged_by_information(record: Record, names: tuple[str, ...]) -> dict[str, float]:
    """Standard errors of the named parameters, frequency among them."""
    lab, state, value = record.beam, record.state, truth_of(record.beam)

    def orbit(beam: Beam, at: np.ndarray) -> tuple:
        """A touch a drive period after another may be lost by rounding: begin beside it then."""
        for side in 1e-15 * np.arange(20.0):
            with contextlib.suppress(Rejected, ValueError):
                return follow(beam, at * (1.0 + side), record.touching, record.period * beam.period)
        raise Rejected("no orbit beside the true one")

    sizes = np.maximum(lab.scale, np.abs(state))
    steps = STEP * sizes
    slopes = [orbit(lab, state + one)[0] - orbit(lab, state - one)[0] for one in np.diag(steps)]
    back = np.linalg.inv(np.eye(state.size) - np.array(slopes).T / (2.0 * steps))

    def readings(beam: Beam) -> np.ndarray:
        """Of the settled orbit at the drive phases of the rows; its state by Newton's method."""
        at = state
        for _ in range(8):
            off = orbit(beam, at)[0] - at
            at = at + back @ off
        if np.abs(off / sizes).max() > 1e-11:
            raise Rejected("no settled orbit beside the true one")
        return tip(beam, orbit(beam, at)[2], record.time * lab.frequency % record.period * beam.period)

    columns, speed = {}, readings(lab)[1]
    for name in names:
        low, high = (readings(changed(lab, name, 1.0 + side * STEP))[0] for side in (-1, 1))
        columns[name] = (high - low) / (2.0 * STEP * value[name])
    columns["frequency"] += record.time / lab.frequency * speed
    jacobian = np.column_stack([*columns.values(), speed / lab.drive, np.ones(speed.size)]) / record.noise_sd
    lengths = np.linalg.norm(jacobian, axis=0)
    inverse = np.linalg.inv(np.linalg.qr(jacobian / lengths, mode="r"))
    return dict(zip(names, (np.linalg.norm(inverse, axis=1) / lengths).tolist(), strict=False))


def blind(record: Record) -> str:
    """The parameters that a record cannot determine; a refusal is justified if there is one."""
    truth = truth_of(record.beam)
    errors = judged_by_information(record, tuple(truth))
    return " ".join(name for name, error in errors.items() if error > MOST.get(name, truth[name]))
