"""How Python becomes machine code.

`compiled`       `kernel` compiles a function and keeps its machine code; `inlined` and `part` are compiled
                 into their callers
`vector_loops`   sums over rows of numbers with the vector instructions of the processor
"""
