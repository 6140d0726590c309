"""Where the bytes of a log are: files, URLs, folders, bags."""
