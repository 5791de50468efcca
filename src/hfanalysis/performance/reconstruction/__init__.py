"""What the fuel did, from the measurement alone: oxidizer to fuel, regression and throat without a regression law.

Sources: Wernimont and Heister, Reconstruction Technique for Reducing Hybrid-Rocket Combustion Test Data, J. Propulsion
and Power 15(1), 1999; Nagata et al., Advances in Aircraft and Spacecraft Science 1(3), 273 (2014); Kamps et al.,
Aerospace 6(4), 45 (2019). The equations here are written from the balances themselves.
"""
