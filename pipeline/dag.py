"""Writes make's rules for the stages, pipeline/dag.mk, from the stages themselves: `make readme`."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.stages import ASIDE, ORDER, RUN, STAGES
from hfanalysis.stages.base import Stage, load_stage

PAGE = Path(__file__).resolve().parent / "dag.mk"

HEAD = """\
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
as_word = '$(subst ','\\'',$(1))'

.SECONDARY:
.SECONDEXPANSION:
.PHONY: always
"""

RAW = "$$(wildcard raw_tests/$$*/*) $(SOURCE)"


def main() -> None:
    PAGE.write_text(rules(), encoding="utf-8")


def rules() -> str:
    """The rules as the stages are now."""
    stages = [load_stage(name) for name in ORDER]
    targets = [f"{name}: ## TEST=… {text.removesuffix('.')}" for name, text in STAGES.items()]
    targets.append(f"{RUN}: ## TEST=… every stage")
    listed = f"STAGES := {' '.join((*ORDER, RUN))}\n\n" + "\n".join(targets) + "\n"
    return "\n".join([HEAD, listed, *(_rule(stage) for stage in stages)])


def _rule(stage: Stage) -> str:
    return (
        f"processed/%/{stage.products[0]}: {_made_from(stage)}\n"
        f"\t@$(HFA) {stage.name} --quiet -- $(call as_word,$*)\n"
        "\t@test $(call as_word,raw_tests/$*/test.toml) -nt $(call as_word,$@) || touch -c $(call as_word,$@)\n"
    )


def _made_from(stage: Stage) -> str:
    """The product of the stage before. A page rests on the raw files: a log without a firing gets one that says so."""
    if not stage.needs:
        return f"{RAW} $(STAMP)"
    if set(stage.wants) >= set(ASIDE):
        return f"{RAW} $(EFFECTS) $(STAMP)"
    before = load_stage(stage.upstream[-1])
    effects = " $(EFFECTS)" if stage.adopts and not before.adopts else ""
    return f"processed/%/{before.products[0]}{effects}"


if __name__ == "__main__":
    main()
