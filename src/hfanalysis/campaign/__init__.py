"""Several tests together: all analysed side by side, and what the tests of one stand agree on."""
