"""The exact motion: flight, touch, flight, ... from one drive period to the next.

`plan`         start, end and samples of a simulation, checked
`event_loop`   flights and contacts one after the other, with strobes and samples between them
`contacts`     a contact under any law, beside which no other is followed
`together`     instants at which several stops are met or let go
`sets`         contacts at several stops, from one instant to the next
`start`        the start of a run, and the errors of one that fails
`recorder`     strobes and samples of a run, and the `Trajectory`; touches: ``contact.touch.passage``
"""
