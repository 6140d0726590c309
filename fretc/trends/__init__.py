"""What is new, fixed, flaky or slower between the rounds of many audits."""
