"""The cache of machine code: its folder, the removal of old folders, and the message on compilation."""

import os
import subprocess
import sys
import time
from pathlib import Path

from contact.machine.compiled import PACKAGE, UNUSED, folder_of, sources_of

ROOT = Path(__file__).parents[2]
CALL = "from contact.flight.elementary import square_root; square_root(2.0, 0.0)"


def test_folders_of_older_sources_are_removed_when_nobody_uses_them(tmp_path):
    """The first process with a new source removes old folders, but keeps one used within the last hour."""
    old, used = tmp_path / "kernels-old", tmp_path / "kernels-used"
    for folder in (old, used):
        folder.mkdir(parents=True)
        (folder / "code.nbc").write_text("")
    os.utime(old, (0.0, time.time() - 2.0 * UNUSED))
    own = Path(folder_of("one", tmp_path))
    assert own.exists() and used.exists() and not old.exists()
    assert Path(folder_of("two", tmp_path)) != own and own.exists()


def test_machine_code_is_keyed_by_all_sources_on_which_it_rests():
    """What a file imports, through packages too: the event loop rests on each law, a law not on the loop."""
    loop, law = PACKAGE / "engine" / "event_loop.py", PACKAGE / "touch" / "power.py"
    assert {law, PACKAGE / "flight" / "elementary.py"} <= sources_of(loop)
    assert loop not in sources_of(law) and PACKAGE / "__init__.py" not in sources_of(loop)
    assert PACKAGE / "touch" / "newton.py" in sources_of(PACKAGE / "touch" / "__init__.py")


def test_the_first_call_that_compiles_says_so_once(tmp_path):
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    for expected in (1, 0):  # the second process finds the machine code of the first
        done = subprocess.run([sys.executable, "-c", CALL], cwd=ROOT, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert done.stderr.count("compiling kernels, about") == expected and done.stdout == ""
