"""Where the map fails near grazing: the letter's Fig. 5."""
