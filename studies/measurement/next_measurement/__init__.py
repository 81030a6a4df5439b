"""Which orbit tells most of the parameters; see `__main__`."""
