"""Which of the named logs an audit is about: those since a time, or some by chance."""
