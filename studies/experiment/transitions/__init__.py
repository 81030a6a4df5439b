"""The main job: the letter's transitions in four descriptions, their orbit diagrams and figures."""
