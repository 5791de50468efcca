"""Real logs of other teams by ``hfa new`` and the facts that their readme states, no code edited: docs/real-logs.md."""
