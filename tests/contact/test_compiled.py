"""The cache of machine code: its folder, the removal of old folders, and the message on compilation."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

from contact.compiled import UNUSED, _cache_folder

ROOT = Path(__file__).parents[2]
CALL = "from contact.flight.elementary import square_root; square_root(2.0, 0.0)"


def test_folders_of_older_sources_are_removed_when_nobody_uses_them(tmp_path):
    """The first process with a new source removes old folders, but keeps one used within the last hour."""
    (tmp_path / "source.py").write_text("# a kernel")
    old, used = tmp_path / "__pycache__" / "kernels-old", tmp_path / "__pycache__" / "kernels-used"
    for folder in (old, used):
        folder.mkdir(parents=True)
        (folder / "code.nbc").write_text("")
    os.utime(old, (0.0, time.time() - 2.0 * UNUSED))
    own = Path(_cache_folder(tmp_path))
    assert own.exists() and used.exists() and not old.exists()
    assert Path(_cache_folder(tmp_path)) == own
    (tmp_path / "source.py").write_text("# another kernel")
    assert Path(_cache_folder(tmp_path)) != own and own.exists()


def test_the_first_call_that_compiles_says_so_once(tmp_path):
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    for expected in (1, 0):  # the second process finds the machine code of the first
        done = subprocess.run([sys.executable, "-c", CALL], cwd=ROOT, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert done.stderr.count("compiling kernels, about") == expected and done.stdout == ""
