"""What all commands share: output, progress, help."""
