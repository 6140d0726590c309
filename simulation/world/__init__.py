"""The robot and the room, and what goes wrong in a scenario."""
