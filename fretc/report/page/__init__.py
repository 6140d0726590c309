"""The HTML page of the report: selection of details, the argument as a tree, layout."""
