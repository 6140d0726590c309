"""What order alone says of comparisons: of one term by cells of its range."""
