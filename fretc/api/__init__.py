"""The functions and classes of `import fretc`; each module holds some of its names.

Input is paths, texts and samples. Output is typed values; bad input raises `Refusal`.
"""
