"""Files for the AJPF model checker."""
