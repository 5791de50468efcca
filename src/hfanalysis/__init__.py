"""Hot-fire test data analysis for nitrous oxide / paraffin hybrid rocket engines."""

__version__ = "0.1.0"
