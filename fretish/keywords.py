"""The reserved words of FRETish: none of them can be a name without quotes."""

KEYWORDS = (
    "after always and at before during eventually except finally first for if immediately in "
    "initially is last mod mode never next not occurrence of only or previous probability same "
    "satisfy shall the then timepoint unless until upon when whenever where while with within xor "
    "tick ticks microsecond microseconds millisecond milliseconds second seconds minute minutes "
    "hour hours"
).split()
"""The key words in lower case, for suggestions."""

UNUSED = frozenset({"what"})
"""Key words of FRET's grammar that no formalizable sentence uses."""
RESERVED = frozenset(
    [
        *KEYWORDS,
        *"sec secs microsec microsecs millisec millisecs true false".split(),
        *UNUSED,
    ]
)
"""All reserved words in lower case; they are reserved in any case. Words that only a target's
language reserves are not among them: the target renames these
(`compiler.logic.spelling.reserved_words`)."""
