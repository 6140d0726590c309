"""Where messages come from: a middleware, or a log that is being recorded."""
