"""How numbers, units and names read: in words, and in the units that people use."""
