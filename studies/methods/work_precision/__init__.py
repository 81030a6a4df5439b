"""Error against cost of every method for impacts."""
