# make        set up, regenerate everything, and prove that it is fresh
# make test   set up, run every test
# make fast   the quick tests only
# make lint   style and types
# make engine                the C engine of virtual devices, compiled into the cache
# make pictures            what the axes do, recorded and drawn anew; the example's needs matplotlib
# make api-docs             pages of the Python API, in build/api
# make bench  figures of speed and memory, beside the peers'
# make bench-client        the client beside python-canopen's, and how many virtual devices a core runs
# make bench-c, sizes      the same of the C runtime: instructions, flash, RAM and stack
# make coverage            lines of the C runtime that the tests execute
# make bench-cross         how much the two runtimes are held to each other, and how fast they answer
# make mutants             every mutant of the runtimes and their tables has to be caught by what proves them equal
# make mutants-sample      200 of them, always the same ones
# make cross-long          C and Python on dialogues at random until CROSS_SECONDS are over; for ever; counts frames
# make fuzz, fuzz-short    events at random until FUZZ_SECONDS are over; for ever; 12,000 that are always the same

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SET_UP := $(VENV)/set-up

# Some shells set it; imports then cost twenty times as much.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: all test fast lint engine api-docs bench bench-client bench-c bench-cross sizes coverage mutants mutants-sample \
    cross-long fuzz fuzz-short pictures clean

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

bench-client: $(SET_UP) engine
	$(BIN)/python bench/bench_client.py
	$(BIN)/python bench/bench_virtual.py

bench-c: $(SET_UP)
	$(BIN)/python bench/bench_c.py

bench-cross: $(SET_UP)
	$(BIN)/python -m bench.bench_cross

sizes: $(SET_UP)
	$(BIN)/python bench/sizes.py

coverage: $(SET_UP)
	rm -rf build/coverage
	ODSMITH_COVERAGE=$(CURDIR)/build/coverage $(BIN)/pytest -q -n auto tests/unit/runtime_c \
	    tests/cross/test_scenarios.py tests/cross/test_protocol.py
	$(BIN)/python bench/coverage_c.py build/coverage

mutants: $(SET_UP)
	$(BIN)/python -m tests.mutants

mutants-sample: $(SET_UP)
	$(BIN)/python -m tests.mutants --sample 200

CROSS_SECONDS ?= 0
CROSS_EXAMPLES ?= 10
CROSS_STEPS ?= 100
CROSS_STRETCH ?= 2000
CROSS_SEED ?= $(shell date +%s)
CROSS = CROSS_EXAMPLES=$(CROSS_EXAMPLES) CROSS_STEPS=$(CROSS_STEPS) CROSS_STRETCH=$(CROSS_STRETCH)

# Each round has a seed of its own; one that fails is named. Frames are those that the device received and sent.
cross-long: $(SET_UP)
	@export CROSS_COUNT=$$(mktemp); trap 'rm -f $$CROSS_COUNT' EXIT; \
	end=$$(($$(date +%s) + $(CROSS_SECONDS))); seed=$(CROSS_SEED); \
	while [ $(CROSS_SECONDS) = 0 ] || [ $$(date +%s) -lt $$end ]; do \
	    set -- tests/cross/test_machine.py --hypothesis-seed=$$seed; \
	    echo "$(CROSS) pytest $$*"; \
	    env -u CI $(CROSS) $(BIN)/pytest -q -n auto "$$@" || \
	        { echo "seed $$seed failed; again: make cross-long CROSS_SEED=$$seed $(CROSS)"; exit 1; }; \
	    echo "seed $$seed: $$($(BIN)/python -m tests.cross.count $$CROSS_COUNT) compared since the beginning," \
	        "no difference"; \
	    seed=$$((seed + 1)); \
	done

FUZZ_SECONDS ?= 0

fuzz: $(SET_UP)
	$(BIN)/python tests/fuzz/fuzz.py --seconds $(FUZZ_SECONDS)

fuzz-short: $(SET_UP)
	$(BIN)/python tests/fuzz/fuzz.py --seed 1 --runs 12000

engine: $(SET_UP)
	$(BIN)/odsmith engine tmcm3230 tmcm6212

pictures: $(SET_UP)
	$(BIN)/python site/motion/draw.py
	$(BIN)/pytest -q tests/unit/test_examples.py -k picture --accept

api-docs: $(SET_UP)
	$(BIN)/python -W error site/api.py build/api

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
