"""Constants of nature and of the two fluids, in SI units per kilomole where molar.

Source: the technical report's appendix A (gas constant, molar weight of air) and NIST for nitrous oxide.
"""

GAS_CONSTANT = 8314.5
"""Universal gas constant [J/(kmol K)]. Source: report, appendix A."""

OXIDIZER_MOLAR_MASS = 44.0128
"""Molar mass of nitrous oxide [kg/kmol]. Source: NIST."""

AIR_MOLAR_MASS = 28.9647
"""Molar mass of air [kg/kmol]. Source: report, appendix A."""

NITROGEN_MOLAR_MASS = 28.0134
"""Molar mass of nitrogen [kg/kmol]. Source: standard atomic weights."""
