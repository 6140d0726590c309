"""Part of the report: whether these requirements can be kept together."""
