"""A run on the instructions that every processor has is refused where numpy or numba keep others."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CHOICE = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NPY_DISABLE_CPU_FEATURES")
GENERIC = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
SIMD = "import numpy; print(*numpy.show_config('dicts')['SIMD Extensions'].get('found', []))"


def answer(*arguments: str, **choice: str) -> subprocess.CompletedProcess[str]:
    env = {name: value for name, value in os.environ.items() if name not in CHOICE} | choice
    command = [sys.executable, *arguments]
    return subprocess.run(command, env=env, capture_output=True, text=True, cwd=ROOT)


def collected(**choice: str) -> subprocess.CompletedProcess[str]:
    return answer("-m", "pytest", "--collect-only", "-p", "no:cacheprovider", __file__, **choice)


@pytest.fixture(scope="module")
def simd() -> list[str]:
    """The features of this processor that numpy uses beyond what every one has."""
    return answer("-c", SIMD).stdout.split()


@pytest.mark.slow
def test_with_every_feature_off_it_runs(simd):
    assert collected(**GENERIC, NPY_DISABLE_CPU_FEATURES=" ".join(simd)).returncode == 0


def test_kernels_for_this_processor_are_refused(simd):
    found = collected(**GENERIC | {"NUMBA_CPU_FEATURES": "+sse3"}, NPY_DISABLE_CPU_FEATURES=" ".join(simd))
    assert found.returncode == pytest.ExitCode.USAGE_ERROR
    assert "numba compiles for generic with +sse3" in found.stderr


@pytest.mark.parametrize("names", [pytest.param("", marks=pytest.mark.slow), "AVX1024 NEON3"])
def test_features_that_numpy_keeps_are_refused(simd, names):
    """NumPy passes over names that it does not know."""
    if not simd:
        pytest.skip("this processor has nothing to switch off")
    found = collected(**GENERIC, NPY_DISABLE_CPU_FEATURES=names)
    assert found.returncode == pytest.ExitCode.USAGE_ERROR
    assert all(f"numpy uses {name}" in found.stderr for name in simd), found.stderr
