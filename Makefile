# `make demo` and `make test` are all that a fresh machine needs: each sets up what it lacks.

SHELL := /bin/sh
VENV := .venv
ORACLE := .venv-oracle
JUDGES := .venv-judges
KINEMATICS := .venv-kinematics
BROWSER := .venv-browser
CLUSTER := .venv-cluster
DOCS := .venv-docs
PYTHON := $(VENV)/bin/python
PIP := $(PYTHON) -m pip -qq --disable-pip-version-check
RUNTIME := $(VENV)/.runtime
DEV := $(VENV)/.dev
unexport PYTHONPATH PYTHONHOME
# Byte code goes into our own environment, whatever is asked for elsewhere: without it each of the
# hundreds of processes that the tests start compiles a thousand modules anew, three seconds each.
unexport PYTHONDONTWRITEBYTECODE
export PYTHONPYCACHEPREFIX := $(CURDIR)/$(VENV)/pycache

.PHONY: help demo test slow check lint setup oracle speed grain campaign campaign-short mutants judges kinematics browser cluster-test docs gallery notebooks libraries lock clean

help:
	@echo "make demo    run the main job on a small case; ends with a report"
	@echo "make test    run the tests"
	@echo "make slow    run the tests that take long and are not part of make test"
	@echo "make check   run the tests, ruff, mypy and the import contracts"
	@echo "make setup   only set up what the others need, in $(VENV)"
	@echo "make oracle  compare our light with Blender Cycles' (fetches it, 370 MB, into $(ORACLE))"
	@echo "make speed   time us against Cycles, bare Mitsuba, solvers, and one worker; an hour"
	@echo "make grain   count Monte-Carlo noise and bias in frames; some minutes"
	@echo "make campaign  do harm to it: hostile inputs, kills, full disks, crowds; hours"
	@echo "make campaign-short  some of that, in three minutes"
	@echo "make mutants  put slips into numeric code and see whether a test notices; an hour"
	@echo "make judges  hold exported datasets and orbits against code that is not ours, in $(JUDGES)"
	@echo "make kinematics  hold our arm's kinematics against Pinocchio's, in $(KINEMATICS)"
	@echo "make browser  open a report in Chromium (from the system) and use it, in $(BROWSER)"
	@echo "make cluster-test  through a real SLURM of two nodes here (from the system) and Dask, in $(CLUSTER)"
	@echo "make docs    build the documentation site into out/docs and check it, in $(DOCS)"
	@echo "make gallery  render the site's pictures anew; ten minutes"
	@echo "make notebooks  run the tutorials that are notebooks, in $(DOCS)"
	@echo "make libraries  build the report's JavaScript libraries anew from npm"
	@echo "make lock    pin the dependencies of pyproject.toml anew"
	@echo "make clean   remove $(VENV), $(ORACLE), $(JUDGES), $(KINEMATICS), $(BROWSER), $(CLUSTER), $(DOCS) and caches; what was rendered under out/ stays"

demo: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(VENV)/bin/rvbench run maxar-demo --out out/demo

test: $(DEV)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -m pytest -m "not slow" --numprocesses auto --maxprocesses 4 --dist loadfile

slow: $(DEV)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -m pytest -m slow --numprocesses auto --maxprocesses 4 --dist loadfile

check: lint test

lint: $(DEV)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	$(VENV)/bin/lint-imports

setup: $(DEV)
	@scripts/ensure_llvm.sh $(PYTHON)

$(PYTHON):
	@scripts/make_environment.sh $(VENV)

# Installs a lock and the house itself, editable; both made of nothing that the lock does not pin.
# Byte code is left to the first import: a third of the time would go into modules never imported.
define install
	@scripts/make_environment.sh $(VENV)
	@echo "installing $(1)"
	@$(PIP) install --no-compile --require-hashes --requirement $(1)
	@$(PIP) install --no-deps --no-build-isolation --editable .
endef

$(RUNTIME): $(PYTHON) requirements.lock pyproject.toml
	$(call install,requirements.lock)
	@touch $@

$(DEV): $(PYTHON) requirements-dev.lock pyproject.toml
	$(call install,requirements-dev.lock)
	@touch $(RUNTIME) $@

oracle: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	@scripts/make_oracle.sh $(ORACLE)
	$(PYTHON) -P -m bench.cycles.oracle

speed: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	@scripts/make_oracle.sh $(ORACLE)
	@failed=0; for what in cycles.speed solver_race throughput; do \
		$(PYTHON) -P -m bench.$$what || failed=1; done; exit $$failed

grain: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -P -m bench.grain.table

campaign: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -P -m bench.campaign hostile --count 10000
	$(PYTHON) -P -m bench.campaign kills --count 1000
	$(PYTHON) -P -m bench.campaign places --count 120

# Each part begins nothing after its seconds, but tries something however slow the machine is.
campaign-short: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -P -m bench.campaign hostile --count 2000 --no-full --seconds 70
	$(PYTHON) -P -m bench.campaign kills --only export --count 6 --seconds 20
	$(PYTHON) -P -m bench.campaign places --only "full disk" --count 1

# In a copy below out/mutants. What was tried is not tried again: the same command goes on.
mutants: $(DEV)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -m tests.mutants $(MUTANTS)

judges: $(DEV)
	@scripts/ensure_llvm.sh $(PYTHON)
	@scripts/make_beside.sh $(JUDGES) requirements-judges.lock "readers of exported datasets, 150 MB"
	$(JUDGES)/bin/python -m pytest tests/judges

kinematics: $(DEV)
	@scripts/make_beside.sh $(KINEMATICS) requirements-kinematics.lock "Pinocchio, 60 MB"
	$(KINEMATICS)/bin/python -m pytest tests/kinematics

browser: $(DEV)
	@scripts/ensure_chromium.sh
	@scripts/make_beside.sh $(BROWSER) requirements-browser.lock "a driver of browsers, 50 MB"
	$(BROWSER)/bin/python -m pytest tests/browser

cluster-test: $(DEV)
	@scripts/ensure_llvm.sh $(PYTHON)
	@scripts/ensure_slurm.sh
	@scripts/make_beside.sh $(CLUSTER) requirements-cluster.lock "a Dask scheduler and workers, 20 MB"
	$(CLUSTER)/bin/python -m pytest tests/cluster

# Sphinx refuses what leads nowhere (-W); check.py reads what it has built. Text alone: no light.
docs: $(DOCS)/.installed
	@rm -rf out/docs
	$(DOCS)/bin/python -P -m sphinx -W --keep-going -q -j auto -c docs/site -d out/docs-read docs out/docs
	@$(DOCS)/bin/python -P docs/site/check.py out/docs
	@echo "docs: $(CURDIR)/out/docs/index.html"

notebooks: $(DOCS)/.installed
	@scripts/ensure_llvm.sh $(DOCS)/bin/python
	PATH="$(CURDIR)/$(DOCS)/bin:$$PATH" $(DOCS)/bin/python -m docs.site.notebooks --run

$(DOCS)/.installed: requirements-docs.lock pyproject.toml
	@scripts/make_environment.sh $(DOCS)
	@echo "installing requirements-docs.lock: what runs, Sphinx and its theme, a notebook's kernel"
	@$(DOCS)/bin/python -m pip -qq --disable-pip-version-check install --no-compile --require-hashes --requirement requirements-docs.lock
	@$(DOCS)/bin/python -m pip -qq --disable-pip-version-check install --no-deps --no-build-isolation --editable .
	@touch $@

gallery: $(RUNTIME)
	@scripts/ensure_llvm.sh $(PYTHON)
	$(PYTHON) -m docs.site.gallery

libraries:
	@scripts/explorer_libraries/build.sh

lock:
	@scripts/lock.sh

clean:
	rm -rf $(VENV) $(ORACLE) $(JUDGES) $(KINEMATICS) $(BROWSER) $(CLUSTER) $(DOCS) .venv-lock build *.egg-info .hypothesis .*_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
