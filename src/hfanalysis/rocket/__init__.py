"""The vehicle that an engine flies in: its drag, its shape, its balance."""
