"""The main job: three descriptions of the letter's transitions, their scans, and the figures."""
