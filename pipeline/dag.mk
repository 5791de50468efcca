# The way through, as rules on real files: what each stage reads and what it writes. Written by `make readme`.
#
# `hfa` judges by content whether a product is up to date; make's time stamps only tell when to ask it.

HFA     := $(BIN)/hfa
TESTS   := $(notdir $(patsubst %/test.toml,%,$(wildcard raw_tests/*/test.toml)))
SOURCE  := $(shell find src/hfanalysis -type f ! -path '*/__pycache__/*')
EFFECTS := $(wildcard engines/*.effects.toml)

.SECONDARY:
.SECONDEXPANSION:

STAGES := ingest health segment calibrate validate diagnose flight report run

ingest: ## TEST=… Read the raw log onto canonical channels in SI, with quality flags per sample
health: ## TEST=… Judge every channel before it is believed: what cannot be used, what is doubted, and what cures it
segment: ## TEST=… Find the phases of the test: valve opening, full feed line, end of the liquid, nitrogen, end
calibrate: ## TEST=… Injector coefficient, feed losses, polytropic exponent and regression, with intervals
validate: ## TEST=… Measure the performance and run the model against the measurement
diagnose: ## TEST=… Which effect the model lacks, with probabilities and proof
flight: ## TEST=… Fly the rocket on the measured thrust: apogee, rail departure, stability; engine files
report: ## TEST=… Write report.html, one page to read offline; on request as PDF, and its plots as PNG and CSV
run: ## TEST=… every stage

processed/%/ingest.h5: $$(wildcard raw_tests/$$*/*) $(SOURCE) $(STAMP)
	@$(HFA) ingest --quiet -- $*
	@touch -c $@

processed/%/health.json: processed/%/ingest.h5
	@$(HFA) health --quiet -- $*
	@touch -c $@

processed/%/segments.json: processed/%/health.json
	@$(HFA) segment --quiet -- $*
	@touch -c $@

processed/%/calibration.json: processed/%/segments.json $(EFFECTS)
	@$(HFA) calibrate --quiet -- $*
	@touch -c $@

processed/%/residuals.h5: processed/%/calibration.json
	@$(HFA) validate --quiet -- $*
	@touch -c $@

processed/%/diagnosis.json: processed/%/calibration.json
	@$(HFA) diagnose --quiet -- $*
	@touch -c $@

processed/%/flight.json: processed/%/calibration.json
	@$(HFA) flight --quiet -- $*
	@touch -c $@

processed/%/report.html: $$(wildcard raw_tests/$$*/*) $(SOURCE) $(EFFECTS) $(STAMP)
	@$(HFA) report --quiet -- $*
	@touch -c $@
