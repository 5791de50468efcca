"""What calibration and diagnosis share: observations, their covariance, hypotheses, fits, the gap, adopted effects."""
