"""Where simulation and measurement disagree: observations, the best model without the effect, and unknown sources."""
