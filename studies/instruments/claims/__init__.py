"""The letter's claims a to e, one file each, and the maps and orbits that they rest on."""
