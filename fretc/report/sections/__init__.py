"""How each part of the report is worked out."""
