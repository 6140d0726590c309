"""The product: what people call, from the shell or from Python."""
