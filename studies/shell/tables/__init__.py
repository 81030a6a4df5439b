"""Tables of numbers as laboratories write them: text with a heading, and the binary files of recorders.

units       units in headings, with their dimension and size in SI
formats     what is special about the files of some instruments
text        the longest run of rows of numbers in a text, the words above it
binary      `read_table` by the first bytes: text, .gz, WAV, MATLAB, universal files, TDMS
"""
