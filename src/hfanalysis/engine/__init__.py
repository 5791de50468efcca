"""The engine's governing equations: so far the self-pressurising oxidizer tank with its feed line and injector."""
