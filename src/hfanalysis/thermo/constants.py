"""Constants of nature and of the two fluids, in SI units per kilomole where molar.

Source: the technical report's appendix A (gas constant, molar weight of air) and NIST for nitrous oxide.
"""

GAS_CONSTANT = 8314.5
"""Universal gas constant as the report uses it [J/(kmol K)]."""

OXIDIZER_MOLAR_MASS = 44.0128
"""Molar mass of nitrous oxide [kg/kmol]."""

AIR_MOLAR_MASS = 28.9647
"""Molar mass of air [kg/kmol]."""

NITROGEN_MOLAR_MASS = 28.0134
"""Molar mass of nitrogen [kg/kmol]."""
