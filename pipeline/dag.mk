# The way through, as rules on real files: what each stage reads and what it writes.
#
#   raw_tests/TEST ──► ingest.h5 ──► segments.json ──► calibration.json ──► residuals.h5 ──► report.html
#                                                                       ├───► diagnosis.json ──┤
#                                                                       └────► flight.json ────┘
#
# `hfa` judges by content whether a product is up to date; make's time stamps only tell when to ask it.

HFA     := $(BIN)/hfa
TESTS   := $(notdir $(patsubst %/test.toml,%,$(wildcard raw_tests/*/test.toml)))
SOURCE  := $(shell find src/hfanalysis -type f ! -path '*/__pycache__/*')
EFFECTS := $(wildcard engines/*.effects.toml)

.SECONDARY:
.SECONDEXPANSION:

processed/%/ingest.h5: $$(wildcard raw_tests/$$*/*) $(SOURCE) $(STAMP)
	@$(HFA) ingest --quiet -- $*
	@touch -c $@

processed/%/segments.json: processed/%/ingest.h5
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

# A log without a firing gets its page too, which says so: the page rests on the raw files, not on every stage's success.
processed/%/report.html: $$(wildcard raw_tests/$$*/*) $(SOURCE) $(EFFECTS) $(STAMP)
	@$(HFA) report --quiet -- $*
	@touch -c $@
