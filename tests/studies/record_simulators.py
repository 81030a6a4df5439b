"""Synthetic laboratory records of a vibro-impact oscillator; ``draw(kind, seed)`` makes one.

A beam is shaken by its clamp, z(t) = A cos(2 pi f t); its tip, displaced by x relative to the clamp,
meets a one-sided stop at x = g.  Two machines are simulated:

``equation_1``  one mode, x'' + mu x' + omega0^2 x = -z'' for x < g, and Newton's law at the stop,
                v -> -restitution v.  Every flight is evaluated in closed form.
``two_modes``   two modes of unit modal mass, q_k'' + c_k q_k' + omega_k^2 q_k = -Gamma_k z'' + phi_k N
                with x = sum phi_k q_k and the elastic contact force N = -K (x - g) for x > g.  The
                transient is followed in closed form, the periodic motion at its end by DOP853.
"""

import contextlib
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

KINDS = ("equation_1", "two_modes")
LONGEST_SETTLING, LONGEST_ORBIT = 3000, 6  # drive periods
MOST_IMPACTS, MOST_EVENTS = 2, 200  # in an orbit; in a drive period, more is taken for chatter
REPEAT, SETTLED = 1e-9, 1e-11  # relative change of a strobed state that repeats: integrated, in closed form
CONTACT = (0.3e-3, 2e-3)  # shortest and longest contact with the elastic stop [s]


@dataclass
class Record:
    """A measured tip displacement; time 0 is an instant at which the drive A cos(2 pi f t) has phase zero."""

    time: np.ndarray  # [s]
    value: np.ndarray  # [m], with noise
    noise_sd: float  # [m]
    beam: "Beam"  # every parameter of the simulation, in SI units
    period: int  # of the orbit [drive periods]
    touches: int  # in the orbit
    state: np.ndarray  # at drive phase zero
    touching: int  # at drive phase zero


class Rejected(Exception):
    """The parameters drawn do not lead to a motion of the kind wanted."""


class Beam:
    """A beam of one or more modes and its stop, rigid (with a restitution) or elastic (with a stiffness)."""

    def __init__(self, omega, c, phi, gamma, gap, frequency, excess, restitution=None, stiffness=None):
        self.omega, self.c, self.phi, self.gamma, self.gap = omega, c, phi, gamma, gap
        self.frequency, self.restitution, self.stiffness = frequency, restitution, stiffness
        self.drive, self.period = 2 * np.pi * frequency, 1 / frequency
        # Steady motion of the modes, without the stop, per metre of clamp amplitude.
        response = gamma * self.drive**2 / (omega**2 - self.drive**2 + 1j * c * self.drive)
        self.grazing_amplitude = gap / abs(phi @ response)
        self.amplitude = (1 + excess) * self.grazing_amplitude
        grazing = self.grazing_amplitude * np.concatenate([response, 1j * self.drive * response])
        self.grazing_state, self.scale = grazing.real, abs(grazing)
        self.pieces = [Piece(self, 0.0)] + ([Piece(self, stiffness)] if stiffness else [])

    def rate(self, t, state, touching):
        """The equations of motion as they stand, for the numerical integration."""
        q, v = np.split(state, 2)
        force = -self.stiffness * (self.phi @ q - self.gap) if touching else 0.0
        shaking = self.amplitude * self.drive**2 * np.cos(self.drive * t)
        return np.concatenate([v, -self.c * v - self.omega**2 * q + self.gamma * shaking + self.phi * force])


class Piece:
    """The linear motion on one side of the stop, in closed form; it holds while side * (x - g) < 0."""

    def __init__(self, beam, stiffness):
        n, phi, self.drive, self.period = len(beam.phi), beam.phi, beam.drive, beam.period
        spring = np.diag(beam.omega**2) + stiffness * np.outer(phi, phi)
        matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-spring, -np.diag(beam.c)]])
        shaking = beam.amplitude * self.drive**2 * np.kron([0, 1], beam.gamma)
        self.phasor = np.linalg.solve(1j * self.drive * np.eye(2 * n) - matrix, shaking)
        self.rest = -np.linalg.solve(matrix, stiffness * beam.gap * np.kron([0, 1], phi))
        self.rates, self.vectors = np.linalg.eig(matrix)
        self.side = -1 if stiffness else 1
        rows = self.side * np.kron(np.eye(2), phi)  # from a state to side * (x - g) and its rate of change
        self.free_rows, self.drive_rows = rows @ self.vectors, rows @ self.phasor
        self.level = rows @ self.rest - self.side * np.array([beam.gap, 0])
        self.shortest = 2 * np.pi / max(self.drive, abs(self.rates.imag).max())
        count = int(np.ceil(64 * self.period / self.shortest))  # samples in a drive period
        self.grid = self.period / count * np.arange(count + 2)
        self.free_grid = np.exp(np.outer(self.rates, self.grid))
        self.drive_grid = np.exp(1j * self.drive * self.grid)

    def fly(self, start, state, end):
        """A flight to the stop, or for a drive period, or to the end: (states, last time, at the stop)."""
        phase = np.exp(1j * self.drive * start)
        free = np.linalg.solve(self.vectors, state - self.rest - (self.phasor * phase).real)
        weights, turn = self.free_rows * free, self.drive_rows * phase
        y, v = (weights @ self.free_grid + np.outer(turn, self.drive_grid)).real + self.level[:, None]
        last = min(end, start + self.period)

        def states(t):
            decaying = (self.vectors * free) @ np.exp(np.multiply.outer(self.rates, t - start))
            steady = np.multiply.outer(self.phasor, np.exp(1j * self.drive * t))
            return ((decaying + steady).real.T + self.rest).T

        def at(delay, row):
            decaying = weights[row] @ np.exp(self.rates * delay)
            return (decaying + turn[row] * np.exp(1j * self.drive * delay)).real + self.level[row]

        def root(low, high, row):
            return brentq(at, low, high, args=(row,), xtol=1e-17, rtol=1e-15)

        # Intervals that end beyond the stop, and those with a summit that may be beyond it.
        summit = (v[:-1] > 0) & (v[1:] <= 0) & (y[:-1] + 2 * v[:-1] * self.grid[1] > 0)
        for j in np.flatnonzero((y[1:] > 0) | summit):
            low, high = self.grid[j], self.grid[j + 1]
            if y[j + 1] <= 0:
                high = root(low, high, 1)
                if at(high, 0) <= 0:
                    continue
            if j == 0 and v[0] < 0 < at(high, 1):  # leaves the stop and comes back at once
                low = root(low, high, 1)
            if at(low, 0) >= 0:
                raise Rejected("chatter")
            touch = start + root(low, high, 0)
            return states, min(touch, last), touch < last
        return states, last, False


def integrate(beam, start, state, touching, end, rtol=1e-13):
    """What ``Piece.fly`` gives, by DOP853; dense samples of the solution show that no touch was missed."""
    piece, n = beam.pieces[touching], len(beam.phi)

    def stop(t, state, touching):
        return beam.phi @ state[:n] - beam.gap

    stop.terminal, stop.direction = True, piece.side
    options = dict(args=(touching,), events=stop, max_step=piece.shortest / 20, dense_output=True)
    digits = dict(method="DOP853", rtol=rtol, atol=0.01 * rtol * beam.scale)
    run = solve_ivp(beam.rate, (start, end), state, **options, **digits)
    fine = np.linspace(start, run.t[-1], 3 + int(320 * (run.t[-1] - start) / piece.shortest))[1:-1]
    if (piece.side * (beam.phi @ run.sol(fine)[:n] - beam.gap) > 1e-12 * beam.gap).any():
        raise Rejected("touch missed by the integration")
    return run.sol, run.t[-1], run.status == 1


def follow(beam, state, touching, end, numerical=False):
    """The motion from time 0, at drive phase zero, to ``end``.

    Returns the last state, whether it touches, the flights as (start, states as a function of time),
    and the events at the stop as (time, touching before it, velocity of the tip at it)."""
    t, flights, events = 0.0, [], []
    while t < end:
        piece, start = beam.pieces[touching], t
        flight = integrate(beam, t, state, touching, end) if numerical else piece.fly(t, state, end)
        states, t, at_stop = flight
        flights.append((start, states))
        state = states(t)
        if at_stop:
            velocity = float(beam.phi @ state[len(beam.phi) :])
            events.append((float(t), touching, velocity))
            if beam.stiffness:
                touching = 1 - touching
            else:
                state = np.array([beam.gap, -beam.restitution * velocity])
        if len(events) > MOST_EVENTS * max(1.0, t / beam.period):
            raise Rejected("chatter")
    return state, touching, flights, events


def tip(beam, flights, times):
    """Displacement and velocity of the tip at times within these flights; shape (2, times)."""
    found = np.empty((2, len(times)))
    owner = np.searchsorted([start for start, _ in flights], times, side="right") - 1
    for i in np.unique(owner):
        found[:, owner == i] = np.kron(np.eye(2), beam.phi) @ flights[i][1](times[owner == i])
    return found


def settle(beam):
    """Follow the motion from grazing until it repeats twice: (length in drive periods, state, touching)."""
    state, touching, strobes = beam.grazing_state, 0, []
    for _ in range(LONGEST_SETTLING):
        strobes = [*strobes[-2 * LONGEST_ORBIT :], state / beam.scale]
        for m in range(1, (len(strobes) - 1) // 2 + 1):
            if np.abs(np.diff(strobes[::-m][:3], axis=0)).max() < SETTLED:
                return m, state, touching
        state, touching, _, _ = follow(beam, state, touching, beam.period)
    raise Rejected("not periodic")


def reading(record, order, on_ground):
    """Velocity (order 1) or acceleration (2) of the tip at the rows of a record, without noise."""
    beam, orbit = record.beam, record.period * record.beam.period
    _, _, flights, events = follow(beam, record.state, record.touching, orbit)
    times = record.time % orbit
    base = on_ground * beam.amplitude * beam.drive**order * np.cos(beam.drive * times + 0.5 * np.pi * order)
    if order == 1:
        return base + tip(beam, flights, times)[1]
    owner = np.searchsorted([start for start, _ in flights], times, side="right") - 1
    hits = [sum(at <= start for at, _, _ in events) for start, _ in flights]
    touching = [(record.touching + count) % 2 if beam.stiffness else 0 for count in hits]
    rows = [(t, flights[k][1](np.array([t]))[:, 0], touching[k]) for t, k in zip(times, owner, strict=True)]
    return base + [beam.phi @ beam.rate(*row)[len(beam.phi) :] for row in rows]


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def draw_beam(kind, rng):
    """A beam with its stop and its drive."""
    gap, excess = log_uniform(rng, 1e-3, 2e-2), log_uniform(rng, 0.002, 0.03)
    f_times_t = rng.uniform(0.75, 1.05)
    if kind == "equation_1":
        natural = log_uniform(rng, 0.020, 0.060)
        mu, restitution = np.array([rng.uniform(0.05, 0.3) / natural]), rng.uniform(0.05, 0.6)
        omega = np.hypot(2 * np.pi / natural, mu / 2)
        return Beam(omega, mu, np.ones(1), np.ones(1), gap, f_times_t / natural, excess, restitution)
    omega = 2 * np.pi * np.array([24.5 * rng.uniform(0.8, 1.25), rng.uniform(90, 200)])
    c = np.array([3.56 * log_uniform(rng, 0.5, 2), log_uniform(rng, 5, 40)])
    phi = np.array([7.69, 5.5]) * rng.uniform(0.85, 1.15, 2)
    gamma = np.array([1.31 * rng.uniform(0.9, 1.1), rng.uniform(-0.6, -0.2)]) / phi
    natural = 2 * np.pi / np.sqrt(omega[0] ** 2 - c[0] ** 2 / 4)
    stiffness = (np.pi / log_uniform(rng, *CONTACT)) ** 2 / (phi @ phi)  # half a period on the stop
    return Beam(omega, c, phi, gamma, gap, f_times_t / natural, excess, stiffness=stiffness)


def attempt(kind, rng):
    """One draw of a record; raises Rejected when the motion is not of the kind wanted."""
    beam = draw_beam(kind, rng)
    m, state, touching = settle(beam)
    orbit = m * beam.period
    _, _, flights, events = follow(beam, state, touching, orbit)
    about = m, sum(side == 0 for _, side, _ in events), state, touching
    if not 1 <= about[1] <= MOST_IMPACTS:
        raise Rejected("number of impacts")
    if kind == "two_modes":
        durations = [
            min((end - t) % orbit for end, after, _ in events if after) for t, side, _ in events if not side
        ]
        if not all(CONTACT[0] <= duration <= CONTACT[1] for duration in durations):
            raise Rejected("contact time")
        for _ in range(2):
            begin, count = state, len(events)
            state, _, flights, events = follow(beam, begin, touching, orbit, numerical=True)
            if len(events) != count or np.abs((state - begin) / beam.scale).max() > REPEAT:
                raise Rejected("integration does not repeat the closed form")
    rows = rate = 0
    while rows < 3 * orbit * rate or rate * beam.period < 16:  # the sampling that the motion needs
        rows, rate = int(log_uniform(rng, 500, 20000)), log_uniform(rng, 500, 10000)
    times, noise_sd = np.arange(rows) / rate, beam.gap * log_uniform(rng, 0.0005, 0.01)
    value = noise_sd * rng.standard_normal(rows) + tip(beam, flights, times % orbit)[0]
    return Record(times, value, noise_sd, beam, *about)


def draw(kind, seed):
    """The record of a kind and a seed."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    while True:
        with contextlib.suppress(Rejected):
            return attempt(kind, rng)
