"""Sources that have no name, one file each: in the flow, in an equation of the model, or in a sensor."""
