"""How names are written in the languages of targets."""
