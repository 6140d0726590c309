"""What a Recording holds, and propositions as truth columns on the clock."""
