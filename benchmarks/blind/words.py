"""Plain names of the figures, in the order of the document."""

FIGURES = {
    "exact_name": "exact name, single effect, d' >= 6 and >= 4 to every rival",
    "exact_name_well_apart": "exact name, single effect, d' >= 6 and >= 6 to every rival",
    "exact_name_no_twin_allowance": "exact name, single effect, d' >= 6, whatever the rivals",
    "twin_group": "right twin group, d' >= 6",
    "set90_coverage": "the 90 % set holds the truth, any d'",
    "set90_coverage_outside": "the 90 % set holds `unknown`, outsiders, any d'",
    "set90_size": "mean size of the 90 % set, d' >= 6",
    "sure_and_wrong": "stated > 0.9, wrong, no twin",
    "false_alarm": "an effect claimed where there is none",
    "outside_unknown_and_equation": "outsider, d' >= 8 after the best of the library: `unknown`, right equation",
    "outside_unknown": "outsider, d' >= 8 after the best of the library: `unknown`",
    "pair_both": "two effects, each d' >= 8 given the other, both named",
    "calibration_error": "calibration error of stated probabilities (debiased)",
    "size_in_90_interval": "90 % interval of the size covers",
    "source_in_90_band": "90 % band of the source over time covers (samples)",
    "onset_in_95_band": "95 % band of the onset covers",
    "gap_closed_same": "gap closed, median: same data",
    "gap_closed_held_out": "gap closed, median: held-out blocks",
    "gap_closed_other_test": "gap closed, median: other test of the stand",
    "gap_closed_placebo": "gap closed, median: placebo",
    "gap_closed_over_placebo": "gap closed beyond the placebo, median of differences",
    "equation_first": "right equation first, claimed or not, d' >= 6",
    "phase": "right phase first, claimed or not, d' >= 6",
    "equation_claimed": "a source claimed in the right equation, d' >= 6",
    "phase_claimed": "a source claimed in the right phase, d' >= 6",
    "no_source_on_none": "no source where there is none",
    "runtime": "one diagnosis [s], median",
    "runtime_90": "one diagnosis [s], 90 % take less",
    "runtime_max": "one diagnosis [s], the longest",
    "log_score": "mean logarithm of the probability of the truth",
}

BASELINE_FIGURES = ("label", "exact_name", "twin_group", "set90_coverage", "set90_size", "sure_and_wrong",
                    "false_alarm", "outside_unknown")  # fmt: skip

INTRODUCTION = """\
Written by `make blind`. Cases, figures and splits are explained in [blind.md](blind.md). Every share has Wilson's 95 %
limits, every median those of the order statistics; "aim" and "met" judge the value itself, not its limits. A diagnosis
that failed counts as one that found nothing: wrong wherever something should have been found, and
no claim."""

WITHOUT_EFFECT = """\
Written by `make blind-none`: every test of the plan in which nothing is hidden, more of them than a part of the whole
benchmark holds. A claim is a verdict other than none; "stated" is the most probable label, which may be another than
none where the verdict makes no claim of it."""

TIMES = """\
From the log to `diagnosis.json` (ingest, segment, calibrate, diagnose), one thread each, as many at a time as there
were jobs; the first case of each process, which loads and compiles, is left out. A case that was
stopped at the time limit counts with that limit."""
