"""Signals of frames: numbers of poses, from the transforms on `/tf` and `/tf_static`."""
