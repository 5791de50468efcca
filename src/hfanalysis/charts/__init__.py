"""Charts as SVG, and their colors."""
