"""The page of a test: its sections, tables and figures; two tests over each other; the index."""
