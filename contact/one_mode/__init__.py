"""Drive periods of one mode under Newton's law, Eq. (1) of the letter (1996), at some ten nanoseconds each.

`period_table`   the motion within a period without sines, and the constants of the mode
`one_impact`     a period with one impact, straight through
`loop`           the proofs that choose between them; any other period goes to the general event loop
"""
