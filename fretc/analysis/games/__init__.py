"""Questions about an arena: who wins, which runs there are, which sets fight."""
