# The course's front door. `make lab` opens it, `make test` checks it; both set up first.

VENV  := .venv
BIN   := $(VENV)/bin
READY := $(VENV)/ready

# The first Python on the PATH for which requirements.lock has wheels, and which can make virtual
# environments. A newer Python would end in an installer's error.
PYTHONS := 3.15 3.14 3.13 3.12 3.11
PYTHON = $(shell for p in python3 $(PYTHONS:%=python%) python; do \
	$$p -c 'import sys, ensurepip; sys.exit(not (3, 11) <= sys.version_info < (3, 16))' \
	2>/dev/null && echo $$p && break; done)
NO_PYTHON = this course needs Python 3.11 to 3.15 with venv, and found none on the PATH \
	(on Debian or Ubuntu: apt install python3 python3-venv)
METHODS := kalman art mdp pomdp arkaq
BENCH := build/bench
REPORT := build/benchmarks
# mushroom-rl brings torch, several GB. It is compared if you put it into build/bench yourself.
PEERS := artlib fast-kalman filterpy pomdp-py pykalman pymdptoolbox quantecon simdkalman statsmodels
PLATFORMS := x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu x86_64-pc-windows-msvc \
	aarch64-apple-darwin

# A registry may stutter.
export PIP_RETRIES := 10
export UV_HTTP_RETRIES := 10
export UV_HTTP_TIMEOUT := 120

.PHONY: help install lab author slides grading student teaching test test-lowest test-newest \
	soak fuzz check reproduce bench guard latency visits live notebooks site site-check lock wheels \
	coverage mutation

help:
	@echo 'make lab        open the course in JupyterLab, in a copy of your own (arkaq-course)'
	@echo 'make author     open the master notebooks, with the solutions'
	@echo 'make test       run every check and every test'
	@echo 'make check      run only the linter and the type checker'
	@echo 'make reproduce  run the experiments of the thesis and write the report'
	@echo 'make bench      measure speed against other libraries; make bench ROOM=kalman for one'
	@echo 'make guard      check in a few seconds that nothing has become twice as slow'
	@echo 'make latency    measure in Chromium how fast every picture follows its slider'
	@echo 'make visits     visit the page of `arkaq explore` fifty times in Chromium'
	@echo 'make live       let the live robot go in Chromium for some minutes'
	@echo 'make site       write the whole course as web pages, into build/site'
	@echo 'make site-check visit every page of build/site in Chromium'
	@echo 'make notebooks  run the notebooks and store what they show'
	@echo 'make install    only make $(VENV), as each of the above does first'
	@echo 'make lock       resolve requirements.lock anew from pyproject.toml'
	@echo 'make wheels     check that the lock installs from wheels on every known system'
	@echo 'make soak       run what takes an hour: kills, interrupts, millions of steps'
	@echo 'make test-lowest  test with the oldest versions that pyproject.toml allows'
	@echo 'make test-newest  test with the newest versions there are'
	@echo 'make fuzz       give the readers of files what they do not expect, for ten minutes'
	@echo 'make coverage   measure which branches of the methods and the agent the tests take'
	@echo 'make mutation   break the methods on purpose, and see which breaks no test notices'

install: $(READY)

lab: $(READY)
	$(BIN)/arkaq lab

# All that the slides load comes along, so that a lecture needs no network.
slides: $(READY)
	npm install --silent --no-save --prefix build/slides reveal.js@4 mathjax@2 requirejs@2 \
		jquery@3
	$(BIN)/arkaq slides build/slides

# nbgrader stays out of the students' environment: JupyterLab would load its extensions.
grading: $(BIN)/uv
	$(BIN)/uv --no-config venv --quiet --clear --python $(BIN)/python build/grading
	$(BIN)/uv --no-config pip install --quiet --python build/grading --requirement requirements.lock \
		--no-deps
	$(BIN)/uv --no-config pip install --quiet --python build/grading 'nbgrader>=0.9.5,<0.10'
	$(BIN)/uv --no-config pip install --quiet --python build/grading --no-deps \
		--no-build-isolation --editable .
	build/grading/bin/python -m pytest tests/test_grading.py

# Every chapter of the student's copy in a real Chromium, blank, and one exercise solved.
student: $(READY)
	EVERY_CHAPTER=1 $(BIN)/python -m pytest tests/browser/student.py

# The list of known mistakes in TEACHING.md comes from the exercises' own tables.
teaching: $(READY)
	$(BIN)/python -c 'from arkaq_edu.release import write_mistakes; write_mistakes("TEACHING.md")'

author: $(READY)
	$(BIN)/python -m jupyterlab notebooks/00_start_here.ipynb

test: check guard
	$(BIN)/python -m pytest -n 2 --dist loadscope

check: $(READY)
	$(BIN)/python -m ruff check
	$(BIN)/python -m ruff format --check
	$(BIN)/python -m mypy

reproduce: $(READY)
	$(BIN)/arkaq reproduce

# Its own environment, so that no peer's pins touch the course. A peer that does not install there
# is left out of the report, with a word. One thread, ours and theirs.
bench: $(BENCH)/ready
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BENCH)/bin/python -m benchmarks $(ROOM) --output $(REPORT)

$(BENCH)/ready: $(BIN)/uv pyproject.toml
	$(BIN)/uv --no-config venv --quiet --clear --python $(BIN)/python $(BENCH)
	$(BIN)/uv --no-config pip install --quiet --python $(BENCH) --requirement pyproject.toml \
		pyperf editables hatchling
	$(BIN)/uv --no-config pip install --quiet --python $(BENCH) --no-deps --no-build-isolation \
		--editable .
	@for peer in $(PEERS); do \
		$(BIN)/uv --no-config pip install --quiet --python $(BENCH) $$peer \
		|| echo "$$peer does not install here: left out"; \
	done
	@touch $(BENCH)/ready

guard: $(READY)
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m benchmarks.guard

latency: $(READY)
	$(BIN)/python -m pytest tests/browser/latency.py -q

visits: $(BIN)/voila
	$(BIN)/python -m pytest tests/browser/visits.py -q

live: $(READY)
	$(BIN)/python -m pytest tests/browser/live.py -q

$(BIN)/voila: $(READY)
	$(BIN)/python -m pip install --quiet voila

# Sphinx stays out of the students' environment.
site: build/site-env/ready
	build/site-env/bin/arkaq site build/site

build/site-env/ready: $(BIN)/uv requirements.lock pyproject.toml
	$(BIN)/uv --no-config venv --quiet --clear --python $(BIN)/python build/site-env
	$(BIN)/uv --no-config pip install --quiet --python build/site-env \
		--requirement requirements.lock --no-deps
	$(BIN)/uv --no-config pip install --quiet --python build/site-env \
		--requirement pyproject.toml --extra site
	$(BIN)/uv --no-config pip install --quiet --python build/site-env --no-deps \
		--no-build-isolation --editable .
	@touch build/site-env/ready

site-check: $(READY)
	$(BIN)/python -m pytest tests/browser/site.py -q

notebooks: $(READY)
	$(BIN)/python notebooks/store.py

# The lock holds hashes and no addresses, so it installs from any mirror.
lock: $(BIN)/uv
	$(BIN)/python -c 'import tomllib; \
		print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")' \
	| $(BIN)/python -m uv pip compile pyproject.toml - --extra test --universal \
		--python-version 3.11 --fork-strategy fewest --generate-hashes --upgrade \
		--no-emit-index-url --no-annotate --no-header --quiet --output-file requirements.lock

wheels: $(BIN)/uv
	@for version in $(PYTHONS); do for platform in $(PLATFORMS); do \
		$(BIN)/uv --no-config pip install --quiet --dry-run --no-deps --only-binary :all: \
			--require-hashes --requirement requirements.lock --target build/wheels \
			--python-version $$version --python-platform $$platform || exit 1; \
		echo "Python $$version, $$platform: all wheels are there"; \
	done; done

# With other versions runs what depends on them most: every module is imported, every kind of
# picture, explorer, environment, file and table is made, a few kernels are compiled. The oldest
# versions are those that pyproject.toml names.
define with_versions
	$(BIN)/uv --no-config venv --quiet --clear --python $(BIN)/python build/$(1)
	$(BIN)/uv --no-config pip install --quiet --python build/$(1) --resolution $(1) \
		--only-binary :all: --requirement pyproject.toml 'hypothesis>=6.115' 'pytest>=8.3'
	NUMBA_CACHE_DIR=build/$(1)/numba PYTHONPATH=$(CURDIR) build/$(1)/bin/python -m pytest -q \
		-o addopts='--doctest-modules --strict-markers' @tests/versions.txt
endef

test-lowest: $(BIN)/uv
	$(call with_versions,lowest-direct)

test-newest: $(BIN)/uv
	$(call with_versions,highest)

# Memory, drift, kills and interrupts over long runs. One process: what is measured is this one's.
soak: $(READY)
	$(BIN)/python -m pytest tests/soak -o python_files='soak_*.py' -p no:xdist

fuzz: $(READY)
	$(BIN)/python -m pip install --quiet --target build/fuzz/atheris --upgrade atheris
	PYTHONPATH=build/fuzz/atheris $(BIN)/python -m tests.fuzz

# Coverage sees into a kernel only where it runs as plain Python.
coverage: $(READY)
	$(BIN)/python -m coverage run -m pytest -q \
		$(METHODS:%=arkaq_edu/%) $(METHODS:%=tests/%)
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m coverage run --append -m pytest -q \
		-p tests.plain $(METHODS:%=arkaq_edu/%) $(METHODS:%=tests/%)
	for room in $(METHODS); do $(BIN)/python -m coverage report \
		--include "arkaq_edu/$$room/*" --fail-under 95 || exit 1; done

# Mutants of the methods: tests/mutation.md tells which survived, and why.
mutation: $(BIN)/uv
	$(BIN)/uv --no-config venv --quiet --clear --python $(BIN)/python build/mutation
	$(BIN)/uv --no-config pip install --quiet --python build/mutation \
		--requirement requirements.lock
	$(BIN)/uv --no-config pip install --quiet --python build/mutation 'cosmic-ray>=8.4'
	$(BIN)/uv --no-config pip install --quiet --python build/mutation --no-deps \
		--no-build-isolation --editable .
	build/mutation/bin/python -m tests.mutation

$(BIN)/uv: $(READY)
	$(BIN)/python -m pip install --quiet uv

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
