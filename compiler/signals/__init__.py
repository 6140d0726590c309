"""What a robot's samples say of the propositions: policies and comparisons, for any language."""
