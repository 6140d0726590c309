"""The words of FRETish's grammar, none of which can be a name without quotes."""

KEYWORDS = (
    "after always and at before during eventually except finally first for if immediately in "
    "initially is last mod mode never next not occurrence of only or previous probability same "
    "satisfy shall the then timepoint unless until upon when whenever where while with within xor "
    "tick ticks microsecond microseconds millisecond milliseconds second seconds minute minutes "
    "hour hours"
).split()
"""As one would write them; for suggestions."""

UNUSED = frozenset({"what"})
"""A key word of FRET's grammar that begins nothing which FRET formalizes."""
RESERVED = frozenset(
    [
        *KEYWORDS,
        *"sec secs microsec microsecs millisec millisecs true false".split(),
        *UNUSED,
    ]
)
"""All of them, in lower case; they are reserved in any case. `what` begins nothing that FRET
formalizes. No other word is reserved: what a target's language keeps for itself is written in
another way there (`compiler.logic.spelling.reserved_words`)."""
