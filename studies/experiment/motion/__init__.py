"""One period of a settled orbit as a film, slow at the collision."""
