"""What all tests need of their surroundings.

One thread for linear algebra: the matrices are small, and threads of several workers get in each other's way.
Ctrl-C as in a terminal: a shell starts what it puts into the background with interrupts ignored, and so would
be the programs that the tests interrupt.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

# the libraries read these once, when numpy is imported; a choice made outside is kept
if "numpy" not in sys.modules:
    for name in THREADS:
        os.environ.setdefault(name, "1")

if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    with contextlib.suppress(ValueError):  # not in the main thread
        signal.signal(signal.SIGINT, signal.default_int_handler)
