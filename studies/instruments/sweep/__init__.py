"""Sweeps: many scans of the drive amplitude, on any executor, into one store.

    tasks.py           columns (one frequency, one direction), batches of their cells, shards
    settled_column.py  settling at one amplitude after the other, as one compiled loop
    column_scan.py     the worker: a batch in, its cells out
    executors.py       threads, processes, or a cluster, all as `concurrent.futures.Executor`
    store.py           one SQLite file a sweep, written by one process
    run.py             the loop that hands out batches and stores what comes back
    columns_file.py    a store as npz or csv
    words.py           what is said to people
"""
