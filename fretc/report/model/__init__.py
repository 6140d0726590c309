"""The values of the report: assessments of requirements, and the views that a reader gets."""
