"""One reader for each kind of table of bindings.toml, and `reader` for all of them."""
