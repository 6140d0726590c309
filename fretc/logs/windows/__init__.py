"""Truth values of propositions over the few samples that a stream keeps."""
