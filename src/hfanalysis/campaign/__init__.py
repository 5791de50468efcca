"""Several tests together: all analyzed side by side, and what the tests of one stand agree on."""
