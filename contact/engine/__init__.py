"""The exact motion: flight, touch, flight, ... from one drive period to the next.

`event_loop`   one flight or contact after the other, strobes and samples between them
`start`        where a run begins, and what is raised if it fails
`recorder`     what a run writes down, and the `Trajectory` made of it
"""
