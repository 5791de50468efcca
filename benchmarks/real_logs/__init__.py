"""Real logs of other teams by ``hfa new`` and the facts their readme states, without a line of code: docs/real-logs.md."""
