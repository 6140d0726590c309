"""The front page: how runs are grouped, the decisive sentence, and the five figures."""
