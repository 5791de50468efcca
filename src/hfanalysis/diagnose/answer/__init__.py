"""What is said in the end: probabilities, sizes, limits, the proof, and words."""
