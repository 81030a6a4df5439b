"""Where each numerical method fails: one file for each family of failures, derived at its head.

A family has the function ``measure(scene, quick) -> Findings``.  One that leaves arrays also has
``draw(arrays) -> (figure, caption)``, and `HOLDS`, which says what they hold.

`model`               shared by the families: the row of a limit and the search for it; a contact that lasts
`explicit`            central difference: limits of the step, and the energy made within them
`splitting`           the stiffest stop that kick, flight, kick can take
`implicit_energy`     energy that implicit methods make in a stiff contact
`false_restitution`   loss or gain that a step adds to an elastic collision
`missed_crossings`    crossings that lie between two looks
`accumulation`        infinitely many impacts in a finite time
"""
