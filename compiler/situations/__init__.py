"""What a run can show of a sentence, and which other sentences it should tell from it."""
