"""Diagnostics: code, message, span and help; and the table of all codes.

A user's mistake is returned as a `Diagnostic`. Its text is in a table, by name
(`messages.py`). The numbers of codes are permanent: never moved, never reused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from enum import Enum, StrEnum

from fretish.classes.frozen import dataclass
from fretish.diagnostics.fixes import Fix
from fretish.diagnostics.source import Span


class Severity(StrEnum):
    """An error stops the command with exit status 2; a warning and a note do not."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Code(Enum):
    """Every code of a message: its permanent number and its summary.

    F1 syntax, F2 meaning, F3 bindings, units and clock, F4 logs, F5 traceability,
    F6 targets, F9 use of the command.
    """

    NOT_FRETISH = ("F101", "the sentence is not FRETish")
    BAD_HEADER = ("F102", "the header is not TOML")
    UNKNOWN_FIELD = ("F103", "the header has a field that fretc does not know")
    MISSING_SATISFY = ("F104", "`satisfy` is missing before the response")
    BAD_FIELD = ("F105", "a header field has a value of the wrong kind")
    NO_SENTENCE = ("F106", "there is no sentence")
    MISSPELT = ("F107", "a key word of FRETish is misspelt")
    BAD_DURATION = ("F108", "a duration is not a whole number of a known unit")
    RESERVED = ("F109", "a reserved word is used as a name")
    BAD_PROBABILITY = ("F110", "the probability is out of range")
    MISSING_COMPONENT = ("F111", "the component is missing")
    WRONG_KIND = ("F112", "a number is used as a truth value, or a truth value as a number")
    UNCLOSED_HEADER = ("F113", "the header has no closing `+++`")
    TOO_DEEP = ("F115", "the sentence is nested too deep")
    NAME_CLASH = ("F116", "two names become one in formulas")
    SEVERAL_SENTENCES = ("F117", "a second sentence has no line `+++` before it")
    FREE_TEXT = ("F114", "free text is kept and not formalized")

    DUPLICATE_ID = ("F201", "two requirements have the same id")
    PREDICATE_NOT_FORMALIZED = (
        "F202",
        "one of the formulas cannot express a temporal predicate",
    )
    EDGE_TRIGGER = ("F204", "`when` and `if` trigger where the condition becomes true")
    NO_TIMING = ("F205", "no timing means eventually")
    SHORT_SCOPE = ("F206", "a deadline after the end of its scope requires nothing")
    FIRST_RUN_ONLY = ("F207", "`after` uses only the first stretch of its mode")
    BEFORE_NOTHING = ("F208", "`before` requires nothing when its mode holds at the start")
    NEVER_DECIDED = ("F203", "no run can ever decide the requirement")
    OWN_TRIGGER = ("F209", "a requirement is triggered by what its component commands")
    NEVER_SO = ("F210", "comparisons contradict each other, or are always true")

    BAD_BINDINGS = ("F301", "the bindings are not TOML")
    UNKNOWN_BINDING_FIELD = ("F302", "the bindings have a field that fretc does not know")
    BAD_BINDING_FIELD = ("F303", "a field of the bindings has a value of the wrong kind")
    UNBOUND = ("F304", "a proposition of the sentence has no binding")
    UNIT_MISMATCH = ("F305", "two quantities have different dimensions")
    UNKNOWN_UNIT = ("F306", "the unit is not known")
    INEXACT_DURATION = ("F307", "the duration is not a whole number of ticks")
    BAD_EXPRESSION = ("F308", "the expression of a binding cannot be read")
    UNKNOWN_NAME = ("F309", "an expression names something that is not declared")
    PARAMETER_DRIFT = ("F310", "the requirement and its binding state different numbers")
    BLIND_ZONE = ("F311", "the bound lies where the sensor reports no values")
    NO_CLOCK = ("F312", "the sentence names a unit of time, but no clock says what a tick is")
    MESSAGE_CLOCK = ("F313", "a clock that ticks by message cannot count seconds")
    NEVER_CHANGED = ("F314", "a proposition never changed in the logs")
    SLOW_TOPIC = ("F315", "a topic sends fewer messages than there are ticks")
    UNKNOWN_BETWEEN = ("F318", "a signal is unknown between the messages of its topic")
    BAD_MODALITY = ("F316", "the modality of a proposition cannot be emitted")

    SAME_TOPIC = ("F320", "two ends of the interceptor are one topic")
    BELOW_PERIOD = ("F321", "a duration is shorter than a tick of the interceptor's timer")
    NO_TIMER = ("F322", "an interceptor without a timer cannot measure time")
    NO_INTERCEPTOR = ("F323", "the bindings declare no interceptor")

    BAD_PHASE = ("F337", "the phase of the clock is not within a tick")
    BAD_LATENESS = ("F355", "the lateness of the clock is not a duration of at most a minute")
    BAD_MEMORY = ("F356", "a signal with memory is not defined correctly")
    PLAIN_PERCENT = ("F338", "a plain number is compared with a signal in percent")
    BAD_FRAMES = ("F360", "a signal of frames is not complete, or cannot be read")
    BAD_GOALS = ("F361", "a signal of an action or a service is not complete, or cannot be read")
    WHICH_UNIT = ("F350", "the unit of a bare number is ambiguous")
    UNIT_IN_SENTENCE = ("F352", "a number in a sentence has a unit, which FRET cannot read")
    SEVERAL_AGGREGATES = (
        "F353",
        "the signals of a comparison have different `agg`",
    )
    NO_ROLE = ("F354", "a variable has no declared role")
    PROSE_DRIFT = ("F351", "title or text state another number than the requirement")
    DEFINITION_CIRCLE = ("F342", "the values of variables or signals form a cycle")
    DOUBLE_DEFINITION = ("F343", "a name is defined in two ways")
    VARIABLE_TYPE = ("F344", "a variable is used against its declared type")
    AMBIGUOUS_UNIT = ("F339", "a part of a unit is also the name of a signal")
    UNKNOWN_WORD = ("F340", "a word is not in the `values` of its signal")
    AMBIGUOUS_WORD = ("F341", "a value of a signal is also the name of another signal")

    UNREADABLE_LOG = ("F401", "the log cannot be read")
    NOT_A_LOG = ("F402", "the file is not a log")
    TRUNCATED_LOG = ("F403", "the log ends in the middle")
    DAMAGED_CHUNK = ("F404", "a part of the log is damaged")
    NO_TOPIC = ("F405", "a topic of the bindings is not in the log")
    NO_FIELD = ("F406", "a field of the bindings is not in the message")
    EMPTY_LOG = ("F407", "the log holds no message")
    UNKNOWN_ENCODING = ("F408", "the encoding of a topic cannot be read")
    WRONG_TYPE = ("F409", "a topic has another type than the bindings say")
    COUNT_MISMATCH = ("F410", "the log has another number of messages than it states")
    OUT_OF_ORDER = ("F411", "the messages of a topic are not in order of time")
    BAD_MESSAGE = ("F412", "a message cannot be decoded")
    SPLIT_LOG = ("F413", "a run in several files cannot be read, or is not read, as one")
    LOST_PART = ("F414", "a file of a run in several files is lost")
    BAG_FORMAT = ("F415", "the format of the log cannot detect all damage")
    ZERO_STAMP = ("F416", "messages of a topic have the time zero")
    CLOCK_JUMP = ("F417", "the clock of a topic jumps")
    MIXED_CLOCKS = ("F418", "the stamps of two topics are of different clocks")
    PROCESS_KILLED = ("F419", "the process that audited the log was killed")
    STILL_CLOCK = ("F420", "the clock of a topic stands still")
    SEVERAL_TYPES = ("F421", "a topic has messages of several types")
    REINDEXED = ("F422", "a reindexed bag has lost its last messages")
    FOREIGN_VALUE = ("F423", "samples are not in the `values` of their signal")
    NO_TRUTH = ("F424", "samples of a truth value are neither 0 nor 1")

    PHASE_DEPENDENT = ("F425", "a verdict depends on the phase of the ticks")
    PHASES_NOT_JUDGED = ("F426", "a verdict was not computed for all phases of the ticks")
    PHASE_PROPOSED = ("F427", "another phase of the ticks gives the same verdicts with more margin")
    NO_WAY = ("F428", "the map has nothing to draw")
    LATE_MESSAGES = ("F429", "messages arrived later than `lateness` allows")
    GRID_OF_WATCH = ("F432", "the ticks begin where those of the recording watch began")
    FOREIGN_GRID = ("F433", "the log names a beginning of the ticks that does not match it")
    MISSED = ("F434", "the watch that recorded the log has missed messages")
    GROWN = ("F431", "a log grew while it was read")
    TIME_OF_ROWS = ("F435", "the time of the rows of a table is not stated")
    NO_TRANSFORM = ("F436", "a log has no transform between the two frames of a signal")
    LOG_OUT_OF_TIME = ("F440", "the audit of a log took longer than allowed")
    AUDIT_OUT_OF_TIME = (
        "F441",
        "the time limit of an audit was reached before all logs were audited",
    )

    UNKNOWN_PARENT = ("F501", "a parent is not declared")
    BAD_HAZARDS = ("F502", "the hazards cannot be read")
    BAD_EVIDENCE = ("F503", "the evidence cannot be read")
    BAD_EXPORT = ("F505", "the requirements of another tool cannot be read")
    STALE_EVIDENCE = ("F504", "the evidence is about another requirement, binding or log")
    FEW_RUNS = ("F506", "a probability is estimated from few runs")
    BAD_LOCK = ("F510", "the lock cannot be read")
    ORPHANED_REVIEW = ("F511", "a review is of a requirement that does not exist")
    CHANGED_SINCE_REVIEW = ("F512", "something has changed since it was reviewed")
    BAD_WAIVER = ("F513", "the waivers cannot be read")
    EXPIRED_WAIVER = ("F514", "a waiver has expired")
    BAD_STORE = ("F516", "a store of evidence cannot be read")
    TWO_EVIDENCES = ("F517", "evidence is in a file and in a store")
    BAD_SETTINGS = ("F520", "the settings of the project cannot be read")
    BAD_PARENTS = ("F521", "a document with parents of requirements cannot be read")
    UNCOVERED_HAZARD = ("F522", "a hazard has no requirement")
    NO_PARENT = ("F523", "a requirement has no parent")
    NUMBER_DRIFT = ("F524", "a comparison of the sentence is bound to another one")
    UNREACHABLE_PLAN = ("F525", "a planned verification method can give no result")
    PARENTS_IN_A_CIRCLE = ("F526", "parents of requirements form a cycle")
    REACHES_NO_HAZARD = ("F527", "the parents of a requirement lead to no hazard")
    MISSPELT_METHOD = ("F528", "a planned method is misspelt")
    UNREVIEWED_VIOLATION = ("F529", "a lock would accept a violated requirement")
    MERGED_VARIABLE = ("F530", "two variables of an export become one")
    RENAMED = ("F531", "a requirement of an export has another id now")
    UNFINISHED_TEXT = ("F532", "an approved requirement still has a text to complete")
    RETIRED_SINCE_REVIEW = ("F540", "a requirement was retired since its review")
    OUTDATED_RESULT = ("F541", "a lock would accept an outdated result")
    UNKNOWN_LOG = ("F542", "a lock would accept a verdict on a log without a SHA-256")
    IDLE_WAIVER = ("F543", "a waiver covers nothing")
    NOT_REVIEWED = ("F544", "a requirement was never reviewed, and others were")
    BAD_ACCEPTANCE = ("F549", "an acceptance names no warning that can be accepted")
    IDLE_ACCEPTANCE = ("F550", "an acceptance matches no present warning")
    BAD_LABEL = ("F551", "a label of runs is wrong")
    LABEL_CONFLICT = ("F552", "a run has several values of one label")
    NO_LABEL = ("F553", "a run has no value of a label")
    NOT_COMPARABLE = ("F560", "audits cannot be compared")
    UNREALIZABLE = ("F561", "requirements are not realizable together")
    NOT_ANALYZED = ("F562", "it is not known whether requirements are realizable together")
    ASSUMED_OF_SYSTEM = ("F563", "an assumption is about what the system chooses")
    BAD_MANIFEST = ("F545", "the manifest cannot be read")
    OTHER_TEXTS = ("F546", "the texts of a review do not match its fingerprints")
    BAD_SIGNERS = ("F548", "the list of signers cannot be read")
    BAD_SIGNATURES = ("F556", "signatures cannot be read")
    BROKEN_SIGNATURE = ("F557", "a signature does not verify")
    NOT_SIGNED = ("F558", "a required signature is missing")
    IDLE_SIGNATURE = ("F559", "a signature does not cover the present content")
    SEVERAL_VERDICTS = ("F555", "audits of one log have several verdicts of a requirement")
    NO_SUCH_REQUIREMENT = ("F515", "there is no requirement or message code of that name")

    NOT_EXPRESSIBLE = ("F601", "the target cannot express the requirement")
    BAD_MONITOR = ("F602", "the file is not a generated monitor")
    BAD_PROPERTY = ("F603", "AJPF would misread a property")
    NOT_PROVED = ("F604", "the formula for AJPF is not proved equivalent to the requirement")
    WEAKENED = ("F605", "the emitted file is weaker than the requirement")
    NO_TIME_TO_REACT = ("F606", "no agent that takes time to react satisfies the property")
    STATE_ZERO = ("F607", "the property requires something of the first state")
    BAD_AGENT = ("F610", "MCAPL would misread an agent")
    BEYOND_MODEL = ("F611", "the agent uses an unsupported part of Gwendolen")
    OTHER_AGENT = ("F612", "a property is about another agent than the given one")
    BAD_PERCEPT = ("F613", "a proposition cannot be a percept")
    NOT_KEPT = ("F614", "the generated agent would violate the requirement")
    OVER_RESPONDS = ("F615", "the generated agent responds more often than required")
    BAD_AJPF_RESULT = ("F616", "a result of AJPF cannot be read")
    FOREIGN_AJPF_RESULT = ("F617", "a result of AJPF belongs to no current requirement")
    NOT_OF_ALL = ("F618", "an output for all requirements cannot include some of them")
    ACTION_NOT_BOUND = ("F619", "an action of the agent is not bound to a topic")
    NOT_TLSF = ("F620", "the file is not a TLSF specification")
    TLSF_OF_FULL_FORMAT = ("F621", "the TLSF specification uses more than the basic format")
    NO_PATTERN = ("F622", "a formula of TLSF is no pattern of FRETish")
    OTHER_SEMANTICS = ("F623", "a TLSF specification has another semantics")
    ASSUMPTION_READS_OUTPUTS = ("F625", "an imported assumption reads outputs")
    NOT_FOR_TLSF = ("F624", "TLSF cannot state a component")
    NOT_A_FORMULA = ("F626", "the text after `formula:` is no formula")
    FORMULA_TOO_LARGE = ("F627", "a formula is too large to be read")
    TOO_LARGE = ("F670", "the output would be too large")

    SHORT_HOLD = ("F630", "the interceptor holds zero no longer than messages may be lost")
    UNWATCHED = ("F631", "the interceptor does not detect silence on a channel")
    EVENT_DRIVEN = ("F632", "the interceptor publishes only when a command arrives")
    LATCHING = ("F633", "the interceptor's first stop is permanent")
    NO_ATTRIBUTION = ("F634", "a package has no maintainer or licence")

    NO_SUCH_FILE = ("F901", "there is no such file")
    IS_A_DIRECTORY = ("F902", "the file is a directory")
    UNREADABLE = ("F903", "the file cannot be read")
    NOT_TEXT = ("F904", "the file is not UTF-8 text")
    NOT_WRITTEN = ("F905", "the output cannot be written")
    UNKNOWN_COMMAND = ("F906", "there is no such command")
    BAD_USAGE = ("F907", "the options or arguments are wrong")
    MISSING_EXTRA = ("F908", "an optional part of fretc is not installed")
    NOTHING_TO_DO = ("F909", "there is nothing to do")
    NO_FLEET = ("F910", "the fleet cannot be reached")
    OTHER_EDITION = ("F911", "a machine of the fleet has no fretc, or another one")
    BUSY = ("F912", "another audit writes the same evidence")
    BAD_QUERY = ("F913", "the query cannot be answered")
    BAD_SCENARIO = ("F914", "the scenario of a simulation cannot be run")
    AGENT_NOT_STARTED = ("F915", "the agent of a simulation cannot be started")
    NOT_IMPORTED = ("F917", "a part of an agent or of its properties is not imported")
    BELIEF_IS_ACTION = ("F918", "a property is about a belief that is an action of the agent")
    AGENT_UNFIT = ("F919", "an agent of your own does not fit the bindings")
    NO_REPORT = ("F916", "messages of the trace of an agent are no reports")
    NO_KEY = ("F920", "the user has no key, so results of an interrupted audit are not kept")
    FOREIGN_PLACE = ("F921", "evidence names a log outside the permitted places")
    TOO_COSTLY = ("F930", "the input needs more CPU time or memory than allowed")
    NOTICE_FAILED = ("F922", "the command of `--notify` did not take the summary")
    BAD_KEY = ("F931", "a key cannot be used")
    FEWER_LIMITS = ("F932", "this operating system has fewer limits of time and memory than Linux")
    PROGRAM_NOT_STARTED = ("F940", "the program under test cannot be started")
    PROGRAM_LINE = ("F941", "the program under test printed a wrong line")
    PROGRAM_SILENT = ("F942", "the program under test printed no line in time")
    PROGRAM_ENDED = ("F943", "the program under test ended before its test")
    NO_LATENESS = ("F950", "a watch by stamps needs the lateness of messages")
    NOTHING_COMES = ("F951", "a watched topic has sent no message")
    NOT_RECORDED = ("F952", "a watch cannot record any more")
    CLOCK_SET_BACK = ("F953", "a clock was set back while a robot was watched")
    REACTION_FAILED = ("F954", "the command of `--on-violation` has failed")
    ROBOT_NOT_REACHED = ("F955", "the watched robot cannot be reached")
    SEVERAL_PUBLISHERS = ("F956", "several nodes publish a watched topic")
    SIMULATED_TIME = ("F957", "a watched robot has a simulated clock")
    NO_DEFINITION = ("F958", "the message definition of a watched topic is missing")
    PUBLISHER_NOT_READ = ("F959", "a publisher of a watched topic cannot be read")
    SERVER_STATUS = ("F960", "the robot's server reports a problem")
    CHANNEL_REFUSED = ("F961", "a channel of a server is not watched")
    PUBLISHER_GONE = ("F962", "a watched topic has no publisher any more")
    NOT_PUBLISHED = ("F963", "the verdicts of a watch cannot be published")
    DISORDERED = ("F964", "a watched log has messages out of order")
    UNNUMBERED = ("F965", "messages of a watched topic have no number")
    NOT_RENAMED = ("F966", "a name cannot be renamed")
    NO_READING = ("F975", "a text in plain English has no reading")
    WORDS_LEFT_OUT = ("F976", "no reading contains some words of a text")
    SEVERAL_READINGS = ("F977", "several readings of a text are left")
    NO_SUCH_READING = ("F978", "the chosen reading does not exist")
    ID_NOT_WRITTEN = ("F979", "a requirement cannot have the id for writing it")
    INTERNAL = ("F999", "internal error in fretc")

    @property
    def number(self) -> str:
        """The permanent number: `F104`."""
        return str(self.value[0])

    @property
    def summary(self) -> str:
        """A phrase that summarizes the code."""
        return str(self.value[1])


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """An error, warning or note: what is wrong, where, and how to fix it."""

    code: Code
    message: str
    span: Span | None = None
    help: str | None = None
    severity: Severity = Severity.ERROR
    paste: str = ""
    """Lines that `help` says to paste into a file."""
    subject: str = ""
    """The topic or hazard of a warning, by which it can be accepted."""
    accepted: str = ""
    """The reason why the project accepts a warning, which is displayed nevertheless."""
    fix: Fix | None = None
    """The fix in `help` as a value, if it replaces a span by a text."""
    related: tuple[Span, ...] = ()
    """Other places that the message is about."""

    @property
    def is_error(self) -> bool:
        """Whether the diagnostic is an error, which stops the command."""
        return self.severity is Severity.ERROR

    @property
    def is_open(self) -> bool:
        """Whether the diagnostic is a warning that was not accepted."""
        return self.severity is Severity.WARNING and not self.accepted


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether any diagnostic is an error."""
    return any(diagnostic.is_error for diagnostic in diagnostics)


class DiagnosticError(Exception):
    """Carries a diagnostic to a caller further up."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


def suggestion(word: str, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """The known word that is most similar to a misspelt one, or None.

    Only words with the same numbers and operators are suggested: `battery < 10` and `battery < 20`
    are different claims.

    Args:
        word: the misspelt word.
        known: the correct words.
        cutoff: the least similarity, from 0 (any) to 1 (equal), as `difflib` measures it.
    """
    from difflib import get_close_matches  # Imported here to make the start faster.

    by_folded = {name.casefold(): name for name in known if _claim(name) == _claim(word)}
    near = get_close_matches(word.casefold(), by_folded, n=1, cutoff=cutoff)
    return by_folded[near[0]] if near else None


def did_you_mean(word: str, known: Iterable[str], otherwise: str) -> str:
    """A help text for a misspelt word: the most similar known word, or else another text."""
    near = suggestion(word, known)
    return f"did you mean `{near}`?" if near else otherwise


def _claim(word: str) -> list[str]:
    """The numbers and operators in a word, in order."""
    parts: list[str] = re.findall(r"\d+|[<>=!&|]+", word)
    return [part.lstrip("0") if part.isdigit() else part for part in parts]
