"""What each governing equation lacks, from the channels alone, without running the model."""
