"""Gwendolen agents and AJPF properties: read, explored, checked."""
