"""What a test is on disk: test.toml, logs of any format, quality flags, products."""
