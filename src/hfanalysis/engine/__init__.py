"""The engine: a module per component (tank, line, injector, grain, chamber, nozzle), and the model composed of them."""
