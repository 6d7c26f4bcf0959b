# Two commands, each with all its own set-up: `make demo` and `make test`. Needs Python 3.11 or newer, and nothing else.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV   ?= .venv
# The release that studies/results was measured with; any torch >= 2.4 does (make demo TORCH='torch>=2.4').
TORCH  ?= torch==2.13.0
BIN    := $(VENV)/bin
DEMO   ?= demo
# Test processes side by side; each begins with its own rooms, and whichever is done takes over from the other.
JOBS   ?= 2
# Bytecode is kept, also where the environment says no: tests start many processes, and each would compile the package.
PYTEST := PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=1 $(BIN)/python -m pytest -q
BESIDE := -n $(JOBS) --dist worksteal
CHAPTERS := tests/chapter3 tests/chapter5 studies/chapter3 studies/chapter5

PYTHONS := 3.11 3.12 3.13

.PHONY: demo test chapters elsewhere pythons slow lint format approve bench docs release clean

demo: $(VENV)/.base
	$(BIN)/gaitdisc demo $(DEMO)

test: $(VENV)/.dev
	$(PYTEST) $(BESIDE)

# Chapters 3 and 5, whose modules lie with the studies: their longer ones as well.
chapters: $(VENV)/.dev
	$(PYTEST) $(BESIDE) -m 'slow or not slow' $(CHAPTERS)

# The same tests, the chapters' among them, with the arithmetic of an older processor (no AVX, no FMA) and in random order: make elsewhere SEED=7
# repeats an order. What numpy found on this machine is switched off, whatever its names are.
elsewhere: $(VENV)/.dev
	@set -e; seed=$${SEED:-$$(od -An -N3 -tu4 /dev/urandom | tr -d ' ')}; echo "order of seed $$seed"; \
	found=$$($(BIN)/python -c 'import numpy; print(*numpy.show_config("dicts")["SIMD Extensions"].get("found", []))'); \
	export NPY_DISABLE_CPU_FEATURES="$$found" OPENBLAS_CORETYPE=Nehalem ATEN_CPU_CAPABILITY=default NUMBA_CPU_NAME=generic; \
	for part in "" "$(CHAPTERS)"; do $(PYTEST) $(BESIDE) --hypothesis-profile many -p randomly --randomly-seed=$$seed $$part; done

# The default suite on each Python of the classifiers, each in its own environment; a release runs it.
pythons:
	@set -e; for version in $(PYTHONS); do $(MAKE) test PYTHON=python$$version VENV=$(VENV)-$$version; done

slow: $(VENV)/.dev
	$(PYTEST) $(BESIDE) -m slow

lint: $(VENV)/.dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/pyright --pythonpath $(BIN)/python

format: $(VENV)/.dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# Texts that differ from those in tests/approved; make approve YES=--yes approves them.
approve: $(VENV)/.dev
	$(BIN)/python tests/approve.py $(YES)

bench: $(VENV)/.dev
	$(BIN)/python benchmarks/read_c3d.py
	$(BIN)/python benchmarks/derivatives.py
	$(BIN)/python benchmarks/study.py
	$(BIN)/python benchmarks/hundred_trials.py
	$(BIN)/python benchmarks/train_networks.py

$(VENV)/.torch:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet '$(TORCH)'
	touch $@

$(VENV)/.base: $(VENV)/.torch pyproject.toml
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

$(VENV)/.dev: $(VENV)/.base
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) $(VENV)-3.* $(DEMO) dist build

docs: $(VENV)/.dev
	$(BIN)/python -m pip install --quiet --editable '.[docs]'
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --site-dir build/site

# A release: versions agree, the changes have their date and every Python passes, or nothing is built; then wheel, sdist
# and pages.
release: $(VENV)/.dev
	$(BIN)/python .ci/agreed_version.py
	$(MAKE) pythons
	$(BIN)/python -m pip install --quiet build
	rm -rf dist
	$(BIN)/python -m build --outdir dist .
	$(MAKE) docs
	ls -l dist build/site/index.html
