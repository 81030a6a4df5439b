"""What the kernels cost, against stated floors and outside solvers in the same run."""
