"""The physics that several chapters use; none of it imports a chapter.

`calibration`      a spring fitted to the numbers that the letter prints
`descriptions`     map, Eq. (1), two parameters, kicks and beam by name: strobed map, fold, scans
`drive_noise`      noise of the drive amplitude, and the period that a noisy motion shows
`least_model`      the least number of modes for a given accuracy
`one_mode`         what Eq. (1) takes from the beam, and where it describes another spring
`parameters`       the numbers of an oscillator by name, for fits and sensitivities
`two_parameters`   restitution and time delay extracted from the beam's collisions
"""
