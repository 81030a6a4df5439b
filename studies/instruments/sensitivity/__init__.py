"""What the letter's errors and the assumptions change: folds, births, noise."""
