# demo: see it work · test: everything CI checks · lint · bench: timings (never a gate)
PYTHON ?= python3
BIN := .venv/bin
.DEFAULT_GOAL := help
.PHONY: help demo test lint bench clean

help:
	@echo "make demo   map a rendered room live and watch it in the browser"
	@echo "make test   linters, types and all tests"
	@echo "make lint   linters and types only"
	@echo "make bench  timings of the engine and the server, as a table"

.venv/slamdeck: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "slamdeck needs Python 3.11 or newer; set PYTHON=...")'
	@echo "setting up .venv, once; this takes about a minute"
	@$(PYTHON) -m venv .venv
	@$(BIN)/pip install --quiet --disable-pip-version-check --editable .
	@touch $@

.venv/slamdeck-dev: .venv/slamdeck
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

web/node_modules: web/package-lock.json .venv/slamdeck-dev
	@PATH="$(CURDIR)/$(BIN):$$PATH" NODE_USE_SYSTEM_CA=1 npm --prefix web ci --no-audit --no-fund --loglevel=error
	@touch $@

demo: .venv/slamdeck
	@$(BIN)/slamdeck demo

lint: .venv/slamdeck-dev web/node_modules
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	PATH="$(CURDIR)/$(BIN):$$PATH" npm --prefix web run --silent check

# Two tests at a time: much of the suite waits for browsers, servers and disks.
test: lint
	$(BIN)/pytest -n 2 --dist worksteal

bench: .venv/slamdeck-dev
	$(BIN)/python -m tests.bench

clean:
	rm -rf .venv web/node_modules
