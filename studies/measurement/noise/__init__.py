"""Fig. 3 of the letter as an experiment with a noisy drive would see it.

``places``      an orbit p_m at a drive frequency, its fold, and the effect of noise there
``scans``       scans of the drive amplitude in noise, simulated
``rates``       the same by formulas
``model``       where orbits end, and the hysteresis that is observed
``figure``      observed hysteresis against frequency
"""
