"""What several studies share, one idea a file.

The scene:  `quantities` (what a key is), `scene_fields` (the table of keys), `scene` (a checked set of
            values), `scene_file` (TOML in and out), `measured_modes` (modes from a CSV file).
The rim:    `command_line` (one function that every study calls), `progress`, `atomic_file`, `record`
            (results and the manifest that says where they come from), `figures` (house style).
"""
