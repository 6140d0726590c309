"""Text read and written, templates, checked JSON, the settings of a project."""
