"""One thread for linear algebra: the matrices are small, and threads of several workers get in each other's
way."""

from __future__ import annotations

import os
import sys

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

# the libraries read these once, when numpy is imported; a choice made outside is kept
if "numpy" not in sys.modules:
    for name in THREADS:
        os.environ.setdefault(name, "1")
