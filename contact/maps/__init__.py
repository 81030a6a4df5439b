"""Drive periods as maps, State -> State, all behind one protocol.

`protocol`                the methods of every strobed or iterated system
`strobed_motion`          compiled motion from strobe to strobe, of any oscillator
`stroboscope`             `StroboscopicMap`: an impact oscillator from strobe to strobe
`nordmark`                `NordmarkMap`: the letter's Eqs. (2), (3)
`nordmark_coefficients`   its coefficients, from a mode, a drive and a restitution
`nordmark_orbits`         its orbits with one impact and their folds in closed form
`nordmark_bands`          the drive frequencies at which each of these orbits appears at grazing
`nonlinear_mode`          `NonlinearMode`: one mode at finite amplitude
`nonlinear_taylor`        flights of that mode by Taylor series
"""
