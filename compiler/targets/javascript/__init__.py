"""JavaScript: a monitor as an ES module."""
