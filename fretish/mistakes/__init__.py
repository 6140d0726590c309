"""What people write in place of FRETish, by subject: operators, the order of the parts."""
