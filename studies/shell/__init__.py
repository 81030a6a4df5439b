"""From a command line to stored results; none of it imports a chapter.

`scene`                   a scene from a TOML file: spring, modes, oscillators
`study`, `run`            a study as a program, and one run of it: results, failures, summary
`options`, `programs`     command line, names of the programs, exit codes
`every_study`             all studies in turn
`files`, `executors`      files that are written whole; threads, processes, progress
`sweep`                   many cells, stored as they come
`plotting`, `film`        figures in the style of the package; moving pictures
`page`                    the page and the site of all results
"""
