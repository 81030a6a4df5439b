"""Between contacts: flights in closed form, and the certified search for the first crossing of the stop.

`elementary`           sine, cosine and exponential to the last place, products without rounding error
`modal_flow`           `Motion`, the numbers of an oscillator, and the flow of its modes
`bounds`               stretches of a flight proved free of a crossing
`crossing`             the first crossing, certified
`sampled_crossing`     the same as the letter looks for it, at a few instants of each drive period
`polynomial_root`      the first crossing of a polynomial
"""
