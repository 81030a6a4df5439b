"""The main job: the letter's transitions in four descriptions, their scans, and the figures."""
