# `make demo` runs the closed loop, `make test` the tests, `make validation` the comparisons with other sources,
# `make docs` builds the documentation; all build .venv if it is missing or out of date.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PACKAGES := comfort controller detector files preview road scenarios vehicle
# The packages stand beside foreride/, but are imported from within it: mypy is shown the tree as a wheel lays it.
MYPY = mkdir -p build/typing/foreride && \
	ln -sfn $(addprefix $(CURDIR)/,$(PACKAGES)) $(CURDIR)/foreride/__init__.py $(CURDIR)/foreride/py.typed build/typing/foreride && \
	ln -sfn $(addprefix $(CURDIR)/,benchmarks docs examples) build/typing && \
	cd build/typing && ../../$(BIN)/mypy --config-file ../../pyproject.toml .

.PHONY: demo test lint docs validation clean

demo: $(VENV)/.installed
	$(BIN)/foreride demo

test: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(MYPY)
	$(BIN)/python -m pytest -n 2
	$(BIN)/foreride regress --jobs 2

$(VENV)/bin/python:
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'foreride needs Python 3.11 or newer')"
	$(PYTHON) -m venv $(VENV) || { echo "Python's venv module is missing: apt-get install python3-venv"; exit 1; }

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/pip install --quiet --disable-pip-version-check -e .
	touch $@

$(VENV)/.installed-dev: pyproject.toml | $(VENV)/bin/python
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[training,dev]"
	touch $@ $(VENV)/.installed

docs: $(VENV)/.installed-docs
	$(BIN)/python -m sphinx -q -W -b html docs build/docs
	@echo build/docs/index.html

validation: $(VENV)/.installed
	$(BIN)/foreride validation --out docs/validation.md

$(VENV)/.installed-docs: pyproject.toml | $(VENV)/bin/python
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[docs]"
	touch $@ $(VENV)/.installed

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(MYPY)

clean:
	rm -rf build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
