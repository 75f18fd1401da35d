# make        set up, regenerate everything, and prove that it is fresh
# make test   set up, run every test
# make fast   the quick tests only
# make lint   style and types
# make bench  figures of speed and memory, beside the peers'

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SET_UP := $(VENV)/set-up

# Some shells set it; imports then cost twenty times as much.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: all test fast lint bench clean

all: $(SET_UP)
	$(BIN)/odsmith build
	$(BIN)/odsmith build --check

test: $(SET_UP)
	$(BIN)/pytest -q -n auto

fast: $(SET_UP)
	$(BIN)/pytest -x -q -n auto -m "not slow"

lint: $(SET_UP)
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

bench: $(SET_UP)
	$(BIN)/python bench/bench.py

clean:
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis

$(SET_UP): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	    { echo "odsmith needs Python 3.11 or newer; name one: make PYTHON=python3.12"; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' || \
	    { echo "odsmith needs Python's venv module (Debian: apt-get install python3-venv)"; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@
