"""What the fuel did, from the measurement alone: oxidizer to fuel, regression and throat without the engine's a and n.

Sources: Wernimont and Heister, Reconstruction Technique for Reducing Hybrid-Rocket Combustion Test Data, J. Propulsion
and Power 15(1), 1999; Nagata et al., Advances in Aircraft and Spacecraft Science 1(3), 273 (2014); Kamps et al.,
Aerospace 6(4), 45 (2019). Of these texts only abstracts were at hand: the equations are written from the balances
themselves. That the throat's area by thrust over pressure is scaled to the radii before and after is also in the
abstract of Aerospace 13(7), 575 (2026).
"""
