"""The spring in motion, as a film and as frames for ParaView.

    time_law.py         when the frames are taken: slow where the ball meets the plate
    filmed_orbit.py     the motion at these times, with strobes, contacts and force
    magnified_shape.py  what is drawn: the higher modes enlarged, tip and ball to scale
    bench.py            what stands around the spring: clamp, plate, table
    view.py             from space to the points of a picture
    scene_bodies.py     the spring and its bench as what a stage draws
    rendered_stage.py   pictures by VTK, where the machine can draw in space
    painted_stage.py    the same pictures by matplotlib, anywhere
    marks.py            words and marks over a picture
    panels.py           strobe points and trace beside it, and the whole frame
    film.py             frames as gif and mp4
    orbit_film.py       the film of an orbit: bodies, shape and view of every frame
    mode_film.py        the film of a mode
    paraview.py         the frames as meshes
    words.py            what is said of the film
    contact_sheet.py    stills on one page
"""
