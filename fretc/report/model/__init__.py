"""What the report says, as frozen values."""
