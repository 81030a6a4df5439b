"""The letter's Fig. 5: scans up and down, the beam that gives it, where p6 is born."""
