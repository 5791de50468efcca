"""An engine on a stand like the one of the report's hot fires, for tests."""

from simulated.engines import engine_on_stand

__all__ = ["engine_on_stand"]
