"""A test's firing put into its rocket: measured thrust, propellant and what is uncertain of them, and their flight."""
