"""Error against cost of every method for impacts.

`problems`           what is solved: Eq. (1), the beam with two contacts, two masses
`methods`            which methods run, at which settings
`model`              error, missed crossings and time of a method at a setting
`reference`          the motion in extended precision, against which errors are measured
`harmonic_balance`   a method for periodic motions, as a competitor
`costs`              time of a drive period against the number of modes, and beside heyoka
`gradients`          error and time of a gradient through impacts
"""
