"""Branches of periodic orbits, followed by arc length, and the events on them.

`curve`               a curve of orbits: its points, one next to another
`branch`              a curve followed both ways
`events`              folds, period doublings, tori, branch points and grazes, each verified
`amplitude_curve`     the curve of a family over the drive amplitude
`continuation`        branches over the drive amplitude: `follow`, `first_event`
`folds`               their folds: `fold_of`, `fold_along_frequency`
`path`                branches along any path p -> oscillator: `follow_path`
`orbit_derivatives`   derivatives of an orbit with respect to parameters
"""
