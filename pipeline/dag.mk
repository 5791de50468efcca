# The way through, as rules on real files: what each stage reads and what it writes. Written by `make readme`.
#
# `hfa` judges by content whether a product is up to date; make's time stamps only tell when to ask it.
#
# Only names of letters, digits and . _ + - @ go into rules, for others may mean something to make or to the shell.
# Where a test or one of its files has another name, `make all` asks hfa for it, without a rule.

HFA     := $(BIN)/hfa
TESTS   := $(shell sh pipeline/tests.sh plain)
ODD     := $(shell sh pipeline/tests.sh odd)
SOURCE  := $(shell find src/hfanalysis -type f ! -path '*/__pycache__/*')
EFFECTS := $(shell find engines -name '*.effects.toml' ! -name '*[!A-Za-z0-9._+@-]*' 2>/dev/null)
EFFECTS += $(if $(shell find engines -name '*[!A-Za-z0-9._+@-]*.effects.toml' -exec echo odd ';' 2>/dev/null),always)

# One word for the shell, whatever is in it.
as_word = '$(subst ','\'',$(1))'

.SECONDARY:
.SECONDEXPANSION:
.PHONY: always

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
	@$(HFA) ingest --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/health.json: processed/%/ingest.h5
	@$(HFA) health --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/segments.json: processed/%/health.json
	@$(HFA) segment --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/calibration.json: processed/%/segments.json $(EFFECTS)
	@$(HFA) calibrate --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/residuals.h5: processed/%/calibration.json
	@$(HFA) validate --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/diagnosis.json: processed/%/calibration.json
	@$(HFA) diagnose --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/flight.json: processed/%/calibration.json
	@$(HFA) flight --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)

processed/%/report.html: $$(wildcard raw_tests/$$*/*) $(SOURCE) $(EFFECTS) $(STAMP)
	@$(HFA) report --quiet -- $(call as_word,$*)
	@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)
