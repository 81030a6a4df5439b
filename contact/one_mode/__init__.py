"""Fast motion of one mode under Newton's law, Eq. (1) of the letter (1996).

A drive period takes some ten nanoseconds to compute.

`period_table`   the motion within a period without sines, and the constants of the mode
`one_impact`     a period with one impact, straight through
`loop`           the proofs that decide which periods take the fast ways; the others go to the event loop
"""
