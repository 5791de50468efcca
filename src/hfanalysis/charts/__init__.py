"""Charts as SVG, and their colours."""
