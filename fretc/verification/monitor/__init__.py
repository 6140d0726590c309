"""The text of a monitor means what its sentence means."""
