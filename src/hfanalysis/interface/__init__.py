"""What Python programs use: a test as an object, engines simulated and designed; the package itself names it."""
