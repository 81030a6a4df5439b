"""Sine, cosine and exponential of the kernels against 50 digits."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np

from contact.flight.elementary import exponential, sine_cosine


def test_sine_cosine_and_exponential_are_good_to_one_unit_in_the_last_place():
    generator = np.random.default_rng(2)
    worst = np.zeros(3)
    with mp.workdps(50):
        for _ in range(4000):
            phase = float(generator.choice([-1, 1]) * 10 ** generator.uniform(-6, 6.5))
            rest = float(generator.uniform(-1, 1) * 1e-16 * abs(phase))
            exact = mp.mpf(phase) + mp.mpf(rest)
            size = 1.5 if abs(phase) < 5e5 else 1e4  # beyond, the library's result is turned by `rest`
            for place, (value, true) in enumerate(
                zip(sine_cosine(phase, rest), (mp.sin(exact), mp.cos(exact)), strict=True)
            ):
                error = abs(float((mp.mpf(value) - true) / math.ulp(abs(float(true)))))
                worst[place] = max(worst[place], error / size)
            x = -float(10 ** generator.uniform(-6, 2.85))
            true = mp.exp(x)
            worst[2] = max(
                worst[2], abs(float((mp.mpf(exponential(x)) - true) / math.ulp(float(true)))) / 1.5
            )
    assert np.all(worst < 1.0)
    assert sine_cosine(0.0, 0.0) == (0.0, 1.0)
    assert exponential(0.0) == 1.0 and exponential(-800.0) == 0.0
