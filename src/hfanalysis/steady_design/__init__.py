"""The steady-state design of an engine, and the size of its tank."""
