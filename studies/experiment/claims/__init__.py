"""Claims of the letter without a figure: loss, secondary bifurcations, universality, period adding."""
