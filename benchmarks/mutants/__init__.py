"""Which small errors in the source the tests of its own room would notice."""
