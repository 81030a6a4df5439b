# make study   the main study on the letter's scene
# make site    the documentation, with a chapter of what is stored: results/site/index.html
# make test    the tests, but for the long forms of some; each names at its end what it skipped and why
# make test-slow  these long forms
# make test-generic  what computes numbers, on the instructions that every processor has
# make lint    style and types
# make clean   caches and build products; results/ and .venv/ stay

PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready
# one thread a process; what Python compiles is kept, without which each program starts a second later
ALONE := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=

.PHONY: study site test test-slow test-generic lint clean

study: $(READY)
	$(BIN)/python -m studies

site: $(READY)
	$(ALONE) $(BIN)/python -m sphinx -W --keep-going -q -j 2 -b html \
		-d docs/made/doctrees docs results/site
	@rm -f results/site/_static/scripts/*.map results/site/_static/styles/*.map
	@echo "the documentation: results/site/index.html"

# `python -m pytest` puts this folder first on the path, so that what is tested is what lies here.
test: $(READY)
	@$(ALONE) $(BIN)/python -m contact.warm_up --all
	$(ALONE) $(BIN)/python -m pytest -n 2 --dist worksteal -rs -m "not slow"

test-slow: $(READY)
	$(ALONE) $(BIN)/python -m pytest -n 2 --dist loadgroup -rs -m slow

# LAPACK and NumPy's loops round otherwise there; kernels compiled in this way are not kept.
NOT_NUMBERS := all_studies docstrings every_study film generic_processor imports letter own_scenes page pictures docs run \
	scene sizes tour wrong_input
NUMBERS := $(filter-out $(foreach name,$(NOT_NUMBERS),%/test_$(name).py),$(wildcard tests/test_*.py tests/contact/test_*.py tests/studies/test_*.py))
SIMD := import numpy; print(*numpy.show_config("dicts")["SIMD Extensions"].get("found", []))
test-generic: $(READY)
	@cache=$$(mktemp -d) && trap 'rm -rf "$$cache"' EXIT && trap 'exit 130' INT TERM && \
	export NUMBA_CACHE_DIR="$$cache" && \
	export NPY_DISABLE_CPU_FEATURES="$$($(BIN)/python -c '$(SIMD)')" && \
	export NUMBA_CPU_NAME=generic NUMBA_CPU_FEATURES= OPENBLAS_CORETYPE=Prescott $(ALONE) && \
	$(BIN)/python -m contact.warm_up --all && \
	$(BIN)/python -m pytest -n 2 --dist worksteal -rs -m "not slow" $(NUMBERS)

lint: $(READY)
	$(BIN)/python -m ruff check beam contact studies tests docs
	$(BIN)/python -m ruff format --check beam contact studies tests docs
	$(BIN)/python -m mypy -p beam -p contact -p studies

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "grazing-spring needs Python 3.11 or later: name one with make PYTHON=/path/to/python3" >&2; exit 1; }
	@echo "installing into .venv (a few minutes the first time)"
	@$(PYTHON) -m venv .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test,docs]'
	@echo "compiling the kernels (about a minute, once)"
	@$(ALONE) $(BIN)/python -m contact.warm_up
	@touch $@

clean:
	rm -rf build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis docs/made docs/examples docs/api/made
	find beam contact studies tests -name __pycache__ -type d -prune -exec rm -rf {} +
