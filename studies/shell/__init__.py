"""From a command line to stored results; none of it imports a chapter.

The command line
    ``programs``      the studies by name and chapter, exit codes, the streams of a program
    ``options``       options that all studies share, and options made of the arguments of a function
    ``study``         the decorator of a study: command line, modes that it needs, interruptions
    ``every_study``   ``python -m studies --all``: all studies in turn

Physical values
    ``scene``         a scene from a TOML file: spring, modes, oscillators

A run and its files
    ``run``           `Run`: what a study gets besides its scene; tables, arrays, verdicts, summary
    ``executors``     threads, processes or a cluster; progress
    ``sweep``         many columns of cells, stored as they come, so that a sweep goes on after a stop
    ``columns``       tables: one value a cell, and the words and the unit of each column
    ``files``         files that are complete or absent; JSON; versions and commit
    ``digits``        numbers in few digits
    ``tables``        tables of numbers as laboratories write them

Pictures and the page
    ``plotting``      figures in the style of the package
    ``painter``       a spring in space at one moment, with text above and a graph below
    ``film``          moments as gif and mp4
    ``page``          one page with the results of all studies, and a site with the documentation
"""
