"""bindings.toml: clock, signals, propositions, units, the interceptor."""
