"""Documents turned into models: the engine of an engine file or a calibrated test, and the rocket that it flies in."""
