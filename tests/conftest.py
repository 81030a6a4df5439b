"""What all tests need of their surroundings.

One thread for linear algebra: the matrices are small, and threads of several workers get in each other's way.
Ctrl-C as in a terminal: a shell starts what it puts into the background with interrupts ignored, and so would
be the programs that the tests interrupt.
A run on the instructions that every processor has (``make test-generic``) is refused where a library keeps
others.
"""

import contextlib
import os
import signal
import sys
import warnings

import pytest

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

# the libraries read these once, when numpy is imported; a choice made outside is kept
if "numpy" not in sys.modules:
    for name in THREADS:
        os.environ.setdefault(name, "1")

if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    with contextlib.suppress(ValueError):  # not in the main thread
        signal.signal(signal.SIGINT, signal.default_int_handler)


def instructions_left() -> list[str]:
    """What is on though the environment asks for the instructions that every processor has."""
    if os.environ.get("NUMBA_CPU_NAME") != "generic" and not os.environ.get("NPY_DISABLE_CPU_FEATURES"):
        return []
    with warnings.catch_warnings():  # told below, in a sentence
        warnings.simplefilter("ignore", ImportWarning)
        import numpy as np
    from numba.core.registry import cpu_target

    left = [f"numpy uses {name}" for name in np.show_config("dicts")["SIMD Extensions"].get("found", [])]
    _triple, processor, features = cpu_target.target_context.codegen().magic_tuple()
    if (processor, features) != ("generic", ""):
        left.append(f"numba compiles for {processor}{features and ' with ' + features}")
    return left


def pytest_configure() -> None:
    """NumPy passes over names of features that it does not know, and every release has names of its own."""
    if left := instructions_left():
        raise pytest.UsageError(f"asked for the instructions of every processor, but {', '.join(left)}")
