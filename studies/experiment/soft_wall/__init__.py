"""A wall of finite stiffness: how it smooths the square root, and the orbits that this adds at grazing."""
