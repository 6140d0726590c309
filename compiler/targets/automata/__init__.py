"""Files that show the reference automaton: HOA, DOT, SMV."""
