"""In which winds a rocket's margin is told."""

WINDS = (2.235, 4.47, 6.706)
"""Head winds [m/s]. Source: report, section 3.2.4: 5, 10 and 15 mph."""

GUST_SEEDS = 20
"""Flights in gusts per wind. Source: by choice; the report has five, whose deviation is known to a third."""
