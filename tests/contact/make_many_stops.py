"""Random problems with several stops, and their answers."""

from itertools import pairwise

import numpy as np
from many_stops_flights import System
from many_stops_judge import Motion, Unordinary, complete

PLACES = ["tip", "b", "c", ("tip", "b"), ("b", "c")]


def random_law(rng: np.random.Generator, mobility: float) -> list:
    if rng.random() < 0.6:
        return ["newton", float(rng.choice((0.0, 0.95 * rng.uniform() ** 1.5), p=(0.15, 0.85)))]
    unit, damping = 10.0 ** rng.uniform(0.0, 1.3), rng.choice((0.0, rng.uniform(0.05, 0.6)))
    return ["linear", unit**2 / mobility, float(damping * unit / mobility)]


def free_heights(problem: dict, row: np.ndarray) -> np.ndarray:
    """Heights of a point in the motion without stops, every 0.02 up to 40, in double precision."""
    names = "omega", "decay_rate", "participation", "load", "v"
    (omega, c, gamma, load, v), s = (np.array(problem[x]) for x in names), np.arange(0.0, 40.0, 0.02)[:, None]
    w, rates = problem["w"], -0.5 * c + 1j * np.sqrt(omega**2 - 0.25 * c**2)
    steady = gamma * problem["amplitude"] * w**2 / (omega**2 - w**2 + 1j * w * c)
    u, du = -load / omega**2 - steady.imag, v - w * steady.real
    free = u - 1j * (du + 0.5 * c * u) / rates.imag
    return (load / omega**2 + (steady * np.exp(1j * w * s)).imag + (free * np.exp(rates * s)).real) @ row


def random_problem(rng: np.random.Generator) -> dict:
    """One to eight modes between one to four stops, with gaps that the motion without them exceeds.

    Some have a load that presses towards a stop, and some two mirrored stops that are hit at one instant.
    """
    n = int(rng.integers(1, 9))
    omega = np.append(1.0, np.sort(rng.uniform(1.3, 40.0, n - 1)))
    phi, b, c, gamma = rng.uniform(-1.0, 1.0, (4, n)) * omega**-0.5 + np.eye(1, n)
    v, count = rng.normal(size=n) * omega**-0.5, rng.choice((1, 2, 3, 4), p=(0.1, 0.2, 0.35, 0.35))
    chosen = rng.choice(2 * len(PLACES), count, replace=False)
    load, strength = np.zeros(n), 1.0
    if rng.random() < 0.6:
        load = rng.choice((-1.0, 1.0)) * rng.uniform(0.3, 5.0) * [phi, b][rng.integers(2)]
        static = [row @ (load / omega**2) for row in (phi, b, c, phi - b, b - c)]
        places = rng.choice(len(PLACES), count, replace=False)
        chosen = [2 * i + (static[i] < 0) for i in places]
        strength = 10.0 ** rng.uniform(-1.0, 0.0)
    mirrored = n > 1 and rng.random() < 0.12
    if mirrored:
        turned = np.arange(n) >= rng.integers(1, n)
        b, chosen = np.where(turned, -phi, phi), [0, 2]
        gamma, v, load = (np.where(turned, 0.0, x) for x in (gamma, v, load))
    problem = {
        "omega": omega.tolist(),
        "decay_rate": (2.0 * 10.0 ** rng.uniform(-3.0, -1.3, n) * omega).tolist(),
        "participation": gamma.tolist(),
        "load": load.tolist(),
        "phi": phi.tolist(),
        "points": {"b": b.tolist(), "c": c.tolist()},
        "w": rng.uniform(0.4, 1.6),
        "amplitude": strength * rng.uniform(0.2, 1.0),
        "q": [0.0] * n,
        "v": v.tolist(),
        "duration": 200.0,
        "stops": [],
    }
    for i in chosen:
        stop = {"gap": 0.0, "at": PLACES[i // 2], "side": int(1 - 2 * (i % 2))}
        row = System(problem | {"stops": [stop | {"law": ["newton", 0.0]}]}).rows[0].astype(float)
        stop["gap"] = rng.uniform(0.1, 0.5) * max(free_heights(problem, row).max(), 0.1)
        stop["law"] = random_law(rng, float(row @ row))
        problem["stops"].append(stop)
    if mirrored:
        problem["stops"][1] |= {name: problem["stops"][0][name] for name in ("gap", "law")}
    return problem


def separate(log: list) -> bool:
    """Whether events of different stops are apart or at one instant."""
    return all(b[0] - a[0] > 1e-9 or {j for _, j in a[1]} == {j for _, j in b[1]} for a, b in pairwise(log))


def judged(rng: np.random.Generator) -> dict:
    """A random problem with its answer, without chaos."""
    while True:
        problem, most = random_problem(rng), int(rng.integers(6, 40))
        system = System(problem)
        motion = Motion(problem, system)
        try:
            motion.run(most=most)
            times = [time for time, _ in motion.log]
            ends = [(a + b) / 2 for a, b in pairwise(times) if b - a > 0.01]
            if len(times) < 6 or not ends or not separate(motion.log):
                continue
            problem = complete(problem | {"duration": float(ends[-1])}, system)
        except Unordinary:
            continue
        if len(problem["answer"]["touches"]) > 5 and problem["answer"]["amplification"] < 4e4:
            return problem
