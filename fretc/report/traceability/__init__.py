"""Links from hazard to review, what has changed, what is waived."""
