"""Which effects, alone or together, or which unknown source, explain what the base model leaves open."""
