"""A requirement explained: pictures, example traces, reasons."""
