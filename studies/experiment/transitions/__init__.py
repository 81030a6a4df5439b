"""The main job: the letter's transitions in four descriptions, and their orbit diagrams: Fig. 2."""
