"""The calibrated model against the measurement: residuals by channel, mode and phase."""
