"""What a contact of finite stiffness does to the square root: orbits, smoothing, measures, figures."""
