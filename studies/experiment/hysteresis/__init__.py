"""Where the p_m orbits end, in nine descriptions, and what makes them differ: the letter's Fig. 3."""
