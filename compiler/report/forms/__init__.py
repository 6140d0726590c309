"""The report in the forms of other tools, each made from the same values as the page."""
