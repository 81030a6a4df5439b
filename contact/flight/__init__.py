"""Between contacts: flights in closed form, and the certified search for the first crossing of the stop.

`elementary`          sine, cosine, exponential and root to the last place, products without rounding error
`numbers`             `Numbers`, the numbers of an oscillator for compiled code
`clock`               times as the number of a stretch and the time since its strobe
`modal_flow`          the closed-form flow of the modes
`tip`                 the tip over the stop as a sum over the modes, and its bounds
`variation`           tangents: derivatives of a motion with respect to its start and its numbers
`bounds`              the three proofs for a span of a flight: no crossing, one root, or one peak
`tip_search`          the tip during a flight: roots and peaks in a bracket, and all peaks
`crossing`            the first crossing, certified
`sampled_crossing`    the first crossing that the letter's samples detect
`polynomial_root`     the first zero of a polynomial, as of a contact force; the roots of a quadratic
"""
