"""Drive periods as maps, State -> State, all behind one protocol.

`protocol`          what every strobed or iterated system offers
`strobed_motion`    the compiled motion from strobe to strobe of any oscillator
`stroboscope`       `StroboscopicMap`: an impact oscillator from strobe to strobe
`nordmark`          `NordmarkMap`: the letter's Eqs. (2), (3)
`nordmark_orbits`   its orbits of one impact and their folds in closed form
`nordmark_bands`    the drive frequencies at which each of them is born
`nonlinear_mode`    `NonlinearMode`: one mode at finite amplitude, with `nonlinear_taylor` for its flights
"""
