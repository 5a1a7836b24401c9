# `make demo` and `make test` are all that a fresh machine needs: each sets up what it lacks.

SHELL := /bin/sh
VENV := .venv
PYTHON := $(VENV)/bin/python
PIP := $(PYTHON) -m pip --quiet --disable-pip-version-check
RUNTIME := $(VENV)/.runtime
DEV := $(VENV)/.dev
unexport PYTHONPATH PYTHONHOME

.PHONY: help demo test check lint setup llvm lock clean

help:
	@echo "make demo    run the main job on a small case: a minute or three, ends with a report"
	@echo "make test    run the tests"
	@echo "make check   run the tests, ruff, mypy and the import contracts"
	@echo "make setup   make $(VENV), to run and to test, and do nothing else"
	@echo "make lock    pin the dependencies of pyproject.toml anew"
	@echo "make clean   remove $(VENV) and caches; what was rendered under out/ stays"

demo: $(RUNTIME) llvm
	$(VENV)/bin/rvbench run maxar-demo --out out/demo

test: $(DEV) llvm
	$(PYTHON) -m pytest -m "not slow"

check: lint test

lint: $(DEV)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	$(VENV)/bin/lint-imports

setup: $(DEV) llvm

# Not a file: a library can be removed from the system at any time, and looking takes a second.
llvm: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)

$(PYTHON):
	@scripts/make_environment.sh $(VENV)

$(RUNTIME): $(PYTHON) requirements.lock pyproject.toml
	@scripts/make_environment.sh $(VENV)
	@echo "installing requirements.lock"
	@$(PIP) install --require-hashes --requirement requirements.lock
	@$(PIP) install --no-deps --no-build-isolation --editable .
	@touch $@

$(DEV): $(RUNTIME) requirements-dev.lock
	@echo "installing requirements-dev.lock"
	@$(PIP) install --require-hashes --requirement requirements-dev.lock
	@touch $@

lock:
	@scripts/lock.sh

clean:
	rm -rf $(VENV) .venv-lock build *.egg-info .hypothesis .mypy_cache .ruff_cache .pytest_cache .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
