# The two commands that matter: `make demo` shows a whole study, `make test` checks everything.
# Both set themselves up; nothing outside this folder is touched.

PYTHON ?= python3
WORKERS ?= 2
# Further words for the command, for example: make demo ARGS="--participants 4"
ARGS ?=

BIN := .venv/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt
DECLARED := pyproject.toml constraints.txt

.DEFAULT_GOAL := help
.PHONY: help demo test test-slow test-fuzz test-smplx test-browser benchmark widgets lint clean

help: ## say what can be made
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 20

demo: .venv/core.stamp ## a whole study with simulated people, into sessions/demo
	$(BIN)/studykit demo $(ARGS)

test: lint ## style, types, layers and all quick tests
	$(BIN)/python -m pytest -p no:benchmark -n $(WORKERS) --dist loadfile $(ARGS)

test-slow: .venv/test.stamp ## the proofs that take minutes
	$(BIN)/python -m pytest -p no:benchmark -m slow $(ARGS)

test-fuzz: .venv/test.stamp ## a hundred thousand broken and hostile files for the importers, some minutes
	$(BIN)/python -m pytest -p no:benchmark -m fuzz -n $(WORKERS) tests/fuzz $(ARGS)

test-smplx: .venv-smplx/smplx.stamp ## our joints beside those of the smplx package (brings torch, 1 GB)
	.venv-smplx/bin/python -m pytest -rs tests/golden/test_smplx_joints.py tests/golden/test_smplx_model.py tests/exports/test_amass.py $(ARGS)

test-browser: .venv/browser.stamp ## the widgets in JupyterLab in a real browser; needs a Chromium
	$(BIN)/python -m pytest -p no:benchmark -m browser -n 0 -rs tests/browser $(ARGS)

benchmark: .venv/dev.stamp ## measurements, no verdicts
	$(BIN)/python -m pytest -m benchmark -n 0 $(ARGS)

widgets: ## bundle the JavaScript of widgets and pages again after changing it; needs Node.js
	cd studykit/widgets/player && npm ci --no-audit --no-fund && npm run build

lint: .venv/test.stamp ## style, types and layers only
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

clean: ## remove what these commands made here; never recorded sessions or libraries
	rm -rf .venv .venv-smplx build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find studykit tests -name __pycache__ -type d -prune -exec rm -rf {} +

# A stamp says what is installed, so that a second call installs nothing.
.venv/made.stamp:
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("studykit needs Python 3.11 or newer; name yours: make demo PYTHON=python3.12")'
	$(PYTHON) -m venv .venv
	@touch $@

.venv/core.stamp: .venv/made.stamp $(DECLARED)
	@echo "Installing studykit into .venv (once, about a minute) ..."
	$(PIP) -e .
	@touch $@

.venv/test.stamp: .venv/made.stamp $(DECLARED)
	@echo "Installing studykit and what its tests need into .venv (once, about a minute) ..."
	$(PIP) -e ".[test]"
	@touch $@ .venv/core.stamp

.venv/dev.stamp: .venv/test.stamp
	$(PIP) -e ".[dev]"
	@touch $@

.venv/browser.stamp: .venv/test.stamp
	$(PIP) -e ".[test,browser]"
	@touch $@

# torch first: smplx alone would bring the newest. A venv of its own keeps torch out of every other test.
.venv-smplx/smplx.stamp: $(DECLARED)
	$(PYTHON) -m venv .venv-smplx
	.venv-smplx/bin/python -m pip install --quiet --disable-pip-version-check torch==2.13.0
	.venv-smplx/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[test]" smplx==0.1.28
	@touch $@
