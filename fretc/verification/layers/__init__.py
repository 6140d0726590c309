"""One module for each layer and each prover of `fretc verify`; `table` names them all."""
