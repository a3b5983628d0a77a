# The course's front door. `make lab` opens it, `make test` checks it; both set up first.

VENV  := .venv
BIN   := $(VENV)/bin
READY := $(VENV)/ready

# The first Python on the PATH that is new enough and can make virtual environments.
PYTHON = $(shell for p in python3 python3.13 python3.12 python3.11 python; do \
	$$p -c 'import sys, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
	&& echo $$p && break; done)
NO_PYTHON = this course needs Python 3.11 or newer with venv, and found none on the PATH \
	(on Debian or Ubuntu: apt install python3 python3-venv)

.PHONY: help install lab test check reproduce bench notebooks lock

help:
	@echo 'make lab        open the course in JupyterLab'
	@echo 'make test       run every check and every test'
	@echo 'make check      run only the linter and the type checker'
	@echo 'make reproduce  run the experiments of the thesis and write the report'
	@echo 'make bench      measure speed against other libraries'
	@echo 'make notebooks  run the notebooks and store what they show'
	@echo 'make install    only make $(VENV), as each of the above does first'
	@echo 'make lock       resolve requirements.lock anew from pyproject.toml'

install: $(READY)

lab: $(READY)
	$(BIN)/arkaq lab

test: check
	$(BIN)/python -m pytest -n 2 --dist loadscope

check: $(READY)
	$(BIN)/python -m ruff check
	$(BIN)/python -m ruff format --check
	$(BIN)/python -m mypy

reproduce: $(READY)
	$(BIN)/arkaq reproduce

bench: $(READY)
	$(BIN)/python -m benchmarks

notebooks: $(READY)
	$(BIN)/python notebooks/store.py

# The lock holds hashes and no addresses, so it installs from any mirror.
lock: $(READY)
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/python -c 'import tomllib; \
		print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")' \
	| $(BIN)/python -m uv pip compile pyproject.toml - --extra test --universal \
		--python-version 3.11 --fork-strategy fewest --generate-hashes --upgrade \
		--no-emit-index-url --no-annotate --no-header --quiet --output-file requirements.lock

# READY names the folder it was made for. Where the clone has moved since, or the Python below
# has gone, what is installed points nowhere and is made again.
ifneq ($(shell $(BIN)/python -c '' 2>/dev/null && cat $(READY) 2>/dev/null),$(CURDIR))
.PHONY: $(READY)
endif

$(READY): requirements.lock pyproject.toml
	$(if $(PYTHON),,$(error $(NO_PYTHON)))
	@echo 'Setting up $(VENV) with $(PYTHON): about 1.2 GB, once, a minute or more.'
	@$(BIN)/python -c '' 2>/dev/null || $(PYTHON) -m venv --clear $(VENV)
	$(BIN)/python -m pip install --require-hashes --requirement requirements.lock
	$(BIN)/python -m pip install --no-deps --no-build-isolation --editable .
	@echo "$(CURDIR)" > $(READY)
