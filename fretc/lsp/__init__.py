"""The language server: what `check`, `explain` and `fmt` know, in an editor.

Input is the texts that an editor shows, saved or not. Output is answers of the Language Server
Protocol. `server.py` speaks the protocol, `session.py` holds the projects, and each other module
answers one kind of question.
"""
