"""Fig. 3 of the letter as an experiment with a noisy drive would see it."""
