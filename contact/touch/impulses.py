"""Impulses of Newton's law at several stops at one instant.

Let d'- be the velocities at which stops are met, with zero for one at rest, and G = W W^T their coupling: the
velocity over stop i that a unit impulse at stop j takes away.  Under Moreau's law the impulses p obey

    p >= 0,    d'+ <= -e d'-,    p (d'+ + e d'-) = 0,    d'+ = d'- - G p

(J. J. Moreau, in: Nonsmooth Mechanics and Applications, CISM 302, Springer 1988, 1-82).  In a sequence one
stop after the other acts by its own restitution, always that with the largest velocity towards it, and of
equals the first, until none is met any more.  ``docs/theory/several.md`` says what is unique.  A restitution
that depends on the speed has its value at the velocity at which the stop is met.

The same complementarity decides over accelerations which points stay at rest on their stops.
"""

import math

import numpy as np

from contact.machine.compiled import kernel

MOST = 8  # largest number of stops that act together: 2^8 sets of acting stops are tried
MOST_TURNS = 100_000  # bound of the impacts of a sequence
DEPENDENT = 1e-11  # part of its mobility below which what other stops leave of a row is rounding
SMALL = 1e-13  # velocities of this part of the largest are rounding


@kernel
def inverse_of(coupling, members, count, out):
    """The inverse of the rows and columns `members` of `coupling`, in the first `count` of `out`.

    A row that depends on those before it is left out, as zeros.  Returns whether all are independent.  Equal
    rows give equal numbers for two members, so that a symmetric motion stays symmetric.
    """
    if count == 2:
        i, j = members[0], members[1]
        a, b, c = coupling[i, i], coupling[i, j], coupling[j, j]
        left = a * c - b * b
        if left > DEPENDENT * a * c:
            out[0, 0], out[0, 1], out[1, 0], out[1, 1] = c / left, -b / left, -b / left, a / left
            return True
    for p in range(count):
        for q in range(count):
            out[p, q] = coupling[members[p], members[q]]
    kept, independent = np.ones(count), True
    for p in range(count):  # Gauss and Jordan, in place
        pivot = out[p, p]
        if not pivot > DEPENDENT * coupling[members[p], members[p]]:
            kept[p], independent = 0.0, False
            continue
        out[p, p] = 1.0
        for q in range(count):
            out[p, q] /= pivot
        for i in range(count):
            if i != p:
                factor = out[i, p]
                out[i, p] = 0.0
                for q in range(count):
                    out[i, q] -= factor * out[p, q]
    for p in range(count):
        for q in range(count):
            if kept[p] * kept[q] == 0.0:
                out[p, q] = 0.0
    return independent


@kernel
def complementary(coupling, members, count, b, z):
    """z >= 0 with G z >= b and z (G z - b) = 0 for the first `count` members of `coupling`, in `z`."""
    largest = 0.0
    for p in range(count):
        z[p], largest = 0.0, max(largest, abs(b[p]))
    if count == 1:
        z[0] = max(b[0], 0.0) / coupling[members[0], members[0]]
        return
    least, inverse = math.inf, np.empty((count, count))
    chosen, at, trial = np.empty(count, np.int64), np.empty(count, np.int64), np.empty(count)
    for acting in range(2**count - 1, -1, -1):
        size = 0
        for p in range(count):
            trial[p] = 0.0
            if (acting >> p) & 1:
                chosen[size], at[size] = members[p], p
                size += 1
        if size > 0 and not inverse_of(coupling, chosen, size, inverse):
            continue
        for i in range(size):
            for j in range(size):
                trial[at[i]] += inverse[i, j] * b[at[j]]
        wrong = 0.0
        for p in range(count):
            left = b[p]
            for q in range(count):
                left -= coupling[members[p], members[q]] * trial[q]
            negative = -trial[p] * coupling[members[p], members[p]]
            wrong = max(wrong, negative if (acting >> p) & 1 else left)
        if wrong < least:
            least = wrong
            for p in range(count):
                z[p] = max(trial[p], 0.0)
        if least <= SMALL * largest:
            return


@kernel
def moreau(coupling, members, count, restitution, before, values):
    """Moreau's law: impulses, velocities after them and energies lost, in the rows of `values`."""
    impulse, after, loss = values
    for p in range(count):
        after[p] = (1.0 + restitution[p]) * before[p]
    complementary(coupling, members, count, after, impulse)
    for p in range(count):
        after[p] = -restitution[p] * before[p]
        if impulse[p] == 0.0:
            after[p] = before[p]
            for q in range(count):
                after[p] -= coupling[members[p], members[q]] * impulse[q]
        loss[p] = 0.5 * impulse[p] * (before[p] + after[p])


@kernel
def sequence(coupling, members, count, restitution, before, values):
    """One stop after the other, see above: as `moreau`.  Returns whether they separate within the bound."""
    impulse, after, loss = values
    largest = 0.0
    for p in range(count):
        impulse[p], after[p], loss[p] = 0.0, before[p], 0.0
        largest = max(largest, abs(before[p]))
    for _ in range(MOST_TURNS):
        next_ = 0
        for p in range(count):
            if after[p] > after[next_]:
                next_ = p
        speed, e, member = after[next_], restitution[next_], members[next_]
        if speed <= SMALL * largest:
            return True
        given = (1.0 + e) * speed / coupling[member, member]
        impulse[next_] += given
        loss[next_] += 0.5 * given * (1.0 - e) * speed
        for p in range(count):
            after[p] = -e * speed if p == next_ else after[p] - coupling[members[p], member] * given
    return False
