"""Where the p_m orbits end, in nine descriptions, and the causes of their differences."""
