"""Error against cost: problems, a reference in extended precision, measures, the front, figures."""
