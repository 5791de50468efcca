"""From an engine file to numbers: what ``hfa simulate`` and ``hfa design`` compute, without a command line."""
