"""What a test says: block means with the covariance of their noise, instants, what was weighed."""
