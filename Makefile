# `make` prints what there is to do. Every target sets up .venv/ first, where that is missing or out of date.

PYTHON ?= python3
TEST   ?=
OTHER  ?=
FLAGS  ?=

VENV  := .venv
BIN   := $(VENV)/bin
STAMP := $(VENV)/.set-up
ROCKETPY := .venv-rocketpy
NOTEBOOKS := .venv-notebooks

# The names go to hfa as they were typed, whatever is in them.
override TEST := $(value TEST)
override OTHER := $(value OTHER)
export TEST OTHER

include pipeline/dag.mk

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help setup $(STAGES) compare campaign all test tests test-all lint format docs code-blocks pictures notebooks benchmark rocketpy real-logs health-rates phases-coverage recovery mutants constants-trial fuzz kills campaign-study joint-study prediction-study last-digits replicas blind blind-none blind-ablations blind-other-table blind-smoke blind-calibrate blind-cases worlds worlds-quick worlds-tried adopted-study readme lock wheel wheels clean flown-thrust coverage narrow-port feed-laws reconstruction oscillations

help: ## this list
	@echo "usage: make TARGET [TEST=HF5] [FLAGS='--force'] [PYTHON=python3.12]"
	@echo
	@sed -n 's/^\([a-z][a-z -]*\):[^#]*## /\1\t/p' $(lastword $(MAKEFILE_LIST)) $(firstword $(MAKEFILE_LIST)) | while IFS="$$(printf '\t')" read -r name text; do \
		printf '  %-16s %s\n' "$$name" "$$text"; done

setup: $(STAMP) ## make .venv/ with the locked packages and the command hfa

$(STAMP): requirements.lock pyproject.toml
	@sh pipeline/setup.sh '$(PYTHON)' $(VENV) requirements.lock --editable .
	@$(BIN)/python pipeline/compile.py
	@touch $@

# The stages print what they found, so they always ask hfa, which redoes only what changed.
$(STAGES): $(STAMP)
	@if [ -z "$$TEST" ]; then \
		echo "make $@: which test? For example: make $@ TEST=$(or $(firstword $(TESTS)),HF5)" >&2; \
		echo "There are: $(or $(TESTS),none in raw_tests/)" >&2; exit 2; fi
	@$(BIN)/hfa $@ $(FLAGS) -- "$$TEST"

compare: $(STAMP) ## TEST=… OTHER=… two tests over each other: processed/TEST/compare_OTHER.html
	@if [ -z "$$TEST" ] || [ -z "$$OTHER" ]; then \
		echo "make compare: which two tests? For example: make compare TEST=HF4 OTHER=HF5" >&2; \
		echo "There are: $(or $(TESTS),none in raw_tests/)" >&2; exit 2; fi
	@$(BIN)/hfa compare $(FLAGS) -- "$$TEST" "$$OTHER"

campaign: $(STAMP) ## every test, several at a time, and what those of one stand agree on: processed/campaign.html
	@$(BIN)/hfa campaign $(FLAGS)

all: $(TESTS:%=processed/%/report.html) ## report.html of every test in raw_tests/
	@[ -z '$(ODD)' ] || sh pipeline/tests.sh each $(HFA) report --quiet --

# A file's tests stay together, for they share what is slow to make, and the files in their order, for the slowest are the
# first ones; linear algebra on one core, for the workers have the others. Byte code is kept, whatever the shell says:
# the processes that tests start would each compile all sources anew.
test: lint tests ## ruff, mypy and the tests

tests: $(STAMP) rocketpy ## the tests alone
	PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=1 $(BIN)/pytest -n 2 --dist loadfile --no-loadscope-reorder $(FLAGS)

PYTHONS ?= python3.11 python3.12 python3.13
# Types are checked by `make lint` alone, with the lowest Python: libraries' types for later ones are written in later words.
test-all: ## the tests under several Pythons, each in an environment of its own: PYTHONS="/path/to/python3.12 …"
	@status=0; for python in $(PYTHONS); do \
		version=$$("$$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || \
			{ echo "make test-all: $$python is not here: not tried" >&2; status=1; continue; }; \
		echo "make test-all: Python $$version" >&2; \
		$(MAKE) --no-print-directory tests PYTHON="$$python" VENV=.venv-$$version || status=1; \
	done; exit $$status

lint: $(STAMP) ## ruff, mypy, and that no room of the package imports one above it
	$(BIN)/ruff check --no-cache
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache --no-logo

format: $(STAMP) ## format the code with ruff
	$(BIN)/ruff format

pictures: $(STAMP) ## the pictures of README and documentation anew, from HF5 and the effects; needs a browser
	$(BIN)/python pipeline/pictures.py
	PYTHONPATH=. $(BIN)/python pipeline/effects_pictures.py
	$(BIN)/python pipeline/diagnosis_pictures.py

docs: $(STAMP) ## the documentation as pages in site/: no warning, no dead link, nothing loaded from elsewhere
	@$(BIN)/python pipeline/site.py

# Jupyter has an environment of its own; the kernel is the project's Python.
notebooks: $(STAMP) rocketpy ## the notebooks executed, with what they show in site/notebooks/; FLAGS='notebooks/NAME.ipynb'
	@test $(NOTEBOOKS)/.set-up -nt requirements-notebooks.lock || { \
		sh pipeline/setup.sh '$(PYTHON)' $(NOTEBOOKS) requirements-notebooks.lock && touch $(NOTEBOOKS)/.set-up; }
	@$(NOTEBOOKS)/bin/python pipeline/notebooks.py "$$PWD/$(BIN)/python" $(FLAGS)

code-blocks: $(STAMP) ## every code block of the documents, those that analyse a test, too; FLAGS=--quick without them
	@$(BIN)/python pipeline/code_blocks.py $(FLAGS)

benchmark: $(STAMP) rocketpy ## start-up, engine and flight beside other solvers, localisation, a 1 GB log beside pandas
	$(BIN)/python -m benchmarks.startup
	$(BIN)/python -m benchmarks.engine_speed
	$(BIN)/python -m benchmarks.reference_engine
	$(BIN)/python -m benchmarks.hrap_run
	$(BIN)/python -m benchmarks.flights
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.localisation
	$(BIN)/python -m benchmarks.diagnosis_speed
	$(BIN)/python -m benchmarks.archive
	$(BIN)/python -m benchmarks.campaign_page
	@if [ -f benchmarks/ingest_1gb.py ]; then set -x; $(BIN)/python -m benchmarks.ingest_1gb --gigabytes 1; fi

# Only the tests and the benchmark use it: it has an environment of its own, and where it cannot be installed they go on
# without it and say so.
rocketpy: ## set up .venv-rocketpy/ with the locked RocketPy, to compare flights with
	@test $(ROCKETPY)/.set-up -nt requirements-rocketpy.lock || { \
		sh pipeline/setup.sh '$(PYTHON)' $(ROCKETPY) requirements-rocketpy.lock && touch $(ROCKETPY)/.set-up; } || \
		echo "make rocketpy: RocketPy cannot be installed here; flights are not compared with it" >&2

random-engines: $(STAMP) ## 10,000 random engines run or are refused with a reason: docs/random-engines.md
	$(BIN)/python -m benchmarks.random_engines --write

health-rates: $(STAMP) ## faults found and healthy logs blamed: docs/health-rates.md; goes on where stopped, FLAGS='--each 10'
	$(BIN)/python -m benchmarks.health_rates --write $(FLAGS)

# They are no part of the repository: make real-logs LOGS=FOLDER, a folder per log.
LOGS ?= ../shared/real_tests
real-logs: $(STAMP) ## logs of other teams by hfa new, their facts and hfa run: docs/real-logs.md; LOGS=FOLDER
	$(BIN)/python -m benchmarks.real_logs --logs '$(LOGS)' --write docs/real-logs.md $(FLAGS)

phases-coverage: $(STAMP) ## how often the intervals of the phases hold, on simulated logs: into docs/phases.md; goes on where stopped
	$(BIN)/python -m benchmarks.phase_coverage --write $(FLAGS)

flown-thrust: $(STAMP) ## flights without the stand's nitrogen and of a separated flow, beside the truth: docs/flight.md
	$(BIN)/python -m benchmarks.flown_thrust --write docs/flight.md $(FLAGS)

recovery: $(STAMP) ## calibrate logs whose truth is known: bias and coverage
	$(BIN)/python -m benchmarks.recovery $(FLAGS)

narrow-port: $(STAMP) ## a gauge at the head of a port as wide as the throat, with and without that: docs/narrow-port.md
	$(BIN)/python -m benchmarks.narrow_port --write

reconstruction: $(STAMP) ## mixtures reconstructed beside known ones: into docs/validation.md; goes on where stopped
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.reconstruction --write docs/validation.md $(FLAGS)

oscillations: $(STAMP) ## oscillations found beside known ones, begin and end: into docs/validation.md; goes on where stopped
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.oscillations --write docs/validation.md $(FLAGS)

coverage: $(STAMP) ## 95 % intervals of simulated tests with systematic errors: docs/coverage.md; goes on where stopped
	OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.coverage --write docs/coverage.md $(FLAGS)

mutants: $(STAMP) ## small errors put into a copy of the source, and whether tests notice: docs/mutants.md; FLAGS='--each 40'
	$(BIN)/python -m benchmarks.mutants --write docs/mutants.md $(FLAGS)

fuzz: $(STAMP) ## 10,000 spoilt logs and test.toml files, and how each ends: docs/fuzz.md; goes on where stopped
	$(BIN)/python -m benchmarks.fuzz run --n 10000 --jobs 2 --write docs/fuzz.md $(FLAGS)

kills: $(STAMP) ## 200 times `make all` killed, interrupted or run twice at once: into docs/fuzz.md
	$(BIN)/python -m benchmarks.kills --n 200 --write docs/fuzz.md $(FLAGS)

constants-trial: $(STAMP) ## which constants without source or evidence change nothing on 24 tests: docs/constants-trial.md
	PYTHONPATH=. $(BIN)/python -m benchmarks.constants_trial --write docs/constants-trial.md $(FLAGS)

feed-laws: $(STAMP) ## injectors that flash and choke, and the replicas, by the report's laws and by others: docs/feed-laws.md
	$(BIN)/python -m benchmarks.feed_laws --write docs/feed-laws.md

prediction-study: $(STAMP) ## the second of two tests predicted from the first, 60 times: into docs/predict.md; goes on where stopped
	$(BIN)/python -m benchmarks.prediction --write docs/predict.md $(FLAGS)

joint-study: $(STAMP) ## 400 draws of 2 to 10 simulated tests of one fuel, or with one of another; into docs/campaign.md
	$(BIN)/python -m benchmarks.joint --write docs/campaign.md $(FLAGS)

campaign-study: $(STAMP) ## 500 tests by a campaign beside two processes, and with workers killed; into docs/campaign.md
	$(BIN)/python -m benchmarks.campaign --write docs/campaign.md $(FLAGS)

last-digits: $(STAMP) ## how far numbers move by the last digits of logs, FLAGS='--cases FOLDER' with others too: docs/last-digits.md
	$(BIN)/python -m benchmarks.last_digits --write docs/last-digits.md $(FLAGS)

blind-cases: $(STAMP) ## tests with hidden effects under .cache/blind/; FLAGS='--n 20' (docs/blind.md)
	$(BIN)/python -m simulated.blind write --jobs 2 $(FLAGS)

# What is found is kept in FOUND, of which a run elsewhere goes on, or makes the page alone. 1 says that cases failed: the
# page says which, so it is written all the same.
BLIND := $(BIN)/python -m benchmarks.blind
FOUND := --archive benchmarks/blind/found/scored.jsonl.xz

blind: $(STAMP) ## 1,500 tests with hidden effects diagnosed and scored: docs/blind-benchmark.md; goes on where stopped
	$(BLIND) run --split scored --n 1500 --jobs 2 $(FOUND) $(FLAGS) || [ $$? -eq 1 ]
	$(BLIND) table --split scored --write docs/blind-benchmark.md --json .cache/blind/cases/scored/figures.json

blind-none: $(STAMP) ## the 330 of them in which nothing is hidden: docs/blind-none.md
	$(BLIND) run --split scored --n 1500 --kind none --jobs 2 --out .cache/blind/none $(FOUND) $(FLAGS) || [ $$? -eq 1 ]
	$(BLIND) table --split scored --none --out .cache/blind/none --write docs/blind-none.md

worlds-quick: $(STAMP) ## 60 tests on other engines, by other loggers and laws: docs/worlds.md; goes on where stopped
	$(BIN)/python -m benchmarks.worlds --jobs 2 --write docs/worlds.md $(FLAGS)

worlds: $(STAMP) ## 364 tests of nine worlds that nothing was fitted to: docs/worlds.md; an evening; goes on where stopped
	$(BIN)/python -m benchmarks.worlds --set scored --limit 1000 --jobs 2 --write docs/worlds.md $(FLAGS)

adopted-study: $(STAMP) ## constants with adopted effects beside the truth, on simulated tests of other worlds: docs/calibration.md
	$(BIN)/python -m benchmarks.adopted --set calibration --limit 120 --write docs/calibration.md $(FLAGS)

worlds-tried: $(STAMP) ## 72 tests of wider worlds: what the diagnosis says of where it was tried (worlds.json)
	$(BIN)/python -m benchmarks.worlds --set calibration --limit 72 --jobs 2 \
		--tried src/hfanalysis/diagnose/answer/worlds.json $(FLAGS)

# A part of the method left out each time, on tests of the kind that it is there for; beside all that is kept, for it is
# the same page. What tempering is there for no simulated test has: `make replicas`.
blind-ablations: $(STAMP) ## what each part of the method is good for: into docs/blind-benchmark.md
	$(BLIND) run --split scored --n 1500 --jobs 2 --keep $(FOUND) || [ $$? -eq 1 ]
	$(call left-out,white_noise,--kind single --targets 8 --each 1)
	$(call left-out,no_projection,--kind pair --limit 400)
	$(BLIND) table --split scored --write docs/blind-benchmark.md

# Of a variant and the tests: the method on them, by the present code, and the variant.
left-out = for variant in '' $(1); do $(BLIND) run --split scored --n 1500 --jobs 2 $(FOUND) \
		$${variant:+--variant $$variant} $(2) $(FLAGS) || [ $$? -eq 1 ] || exit; done

replicas: $(STAMP) ## HF5 and HF4 diagnosed, each proven on the other, and without each part of the method: docs/diagnosis.md
	$(BIN)/python -m benchmarks.replicas --write docs/diagnosis.md

blind-other-table: $(STAMP) ## 130 tests that hide nothing, of nitrous oxide by another table, the figures on the screen
	$(BIN)/python -m benchmarks.other_tables .cache/blind/other-table
	$(BLIND) run --split calibration --n 1500 --seed 15 --kind none --limit 495 --jobs 2 --out .cache/blind/other-table $(FLAGS) || [ $$? -eq 1 ]
	$(BLIND) table --split calibration --none --out .cache/blind/other-table

blind-smoke: $(STAMP) ## 24 of them from the development split, the figures on the screen
	$(BLIND) run --split development --n 24 --jobs 2 --out .cache/blind/smoke $(FLAGS) || [ $$? -eq 1 ]
	$(BLIND) table --split development --out .cache/blind/smoke

blind-calibrate: $(STAMP) ## fit the stated probabilities on 600 tests of the calibration split
	$(BLIND) run --split calibration --n 600 --jobs 2 $(FLAGS) || [ $$? -eq 1 ]
	$(BLIND) calibrate --split calibration

readme: $(STAMP) ## write anew what comes of the code: samples in README.md, docs/effects.md, docs/constants.md, docs/channels.md, docs/products.md, docs/schemas, make's rules
	@$(BIN)/python pipeline/readme.py
	@PYTHONPATH=. $(BIN)/python pipeline/effects_page.py
	@$(BIN)/python pipeline/products_page.py
	@$(BIN)/python pipeline/dag.py
	@$(BIN)/python pipeline/constants_page.py
	@$(BIN)/python pipeline/channels_page.py

COMPILE := $(BIN)/uv pip compile --universal --python-version 3.11 --only-binary :all: --upgrade --generate-hashes \
	--no-emit-index-url --custom-compile-command 'make lock' --quiet

lock: $(STAMP) ## write the lock files anew from pyproject.toml
	$(COMPILE) pyproject.toml --extra dev -o requirements.lock
	$(COMPILE) --group rocketpy --constraint requirements.lock -o requirements-rocketpy.lock
	$(COMPILE) --group notebooks --constraint requirements.lock -o requirements-notebooks.lock

wheel: $(STAMP) ## the wheel built, installed by itself, and hfa demo and hfa run HF5 in an empty folder, with their times
	@sh pipeline/try_wheel.sh '$(PYTHON)' "$$PWD/$(BIN)"

wheels: $(STAMP) ## on which platforms every package that runs need has a wheel, and what they take: into docs/machines.md
	$(BIN)/python pipeline/wheels.py

clean: ## remove processed/ and caches; raw_tests/ and .venv/ stay
	rm -rf processed site .mypy_cache .ruff_cache .pytest_cache .hypothesis .cache dist
	find src tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +
