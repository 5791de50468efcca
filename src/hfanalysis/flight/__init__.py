"""The rocket's flight in one dimension."""
