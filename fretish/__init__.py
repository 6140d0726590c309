"""The language: text, its tree, its meaning in English, and the declarations beside it."""
