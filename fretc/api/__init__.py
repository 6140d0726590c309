"""What `import fretc` offers: each module holds some of its names."""
