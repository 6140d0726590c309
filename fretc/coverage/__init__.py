"""What recorded runs have exercised: situations of requirements, and wrong requirements."""
