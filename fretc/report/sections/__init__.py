"""The parts of the report: each module makes the views of one part."""
