"""What a firing measured: its table of numbers, its histories, reconstruction, stability and transients."""
