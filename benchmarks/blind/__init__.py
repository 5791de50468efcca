"""The blind benchmark at full size: run every case, write the tables, calibrate the stated probabilities.

python -m benchmarks.blind run|table|calibrate: see docs/blind.md.
"""
