"""The reserved words of each target's language, which no user's name may be.

A name in the table of a target is renamed there by `legal_names`, or quoted. Besides the key words
of a language, a table has the names in generated code that a user's name would shadow. Each table
names its source.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Container

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class ReservedWords(Container[str]):
    """Words, and a pattern for families of words."""

    words: frozenset[str]
    family: str = ""
    """The regular expression; empty: there is none. It is compiled when it is first used."""

    def __contains__(self, name: object) -> bool:
        if self.family and isinstance(name, str) and re.fullmatch(self.family, name):
            return True
        return name in self.words

    def __or__(self, more: Collection[str]) -> ReservedWords:
        """The words with some more words."""
        return ReservedWords(self.words.union(more), self.family)


def _words(text: str, family: str = "") -> ReservedWords:
    return ReservedWords(frozenset(text.split()), family)


FRET = _words(
    """
    MODULE DEFINE MDEFINE CONSTANTS VAR IVAR FROZENVAR INIT TRANS INVAR SPEC CTLSPEC LTLSPEC PSLSPEC
    COMPUTE NAME INVARSPEC FAIRNESS JUSTICE COMPASSION ISA ASSIGN CONSTRAINT SIMPWFF CTLWFF LTLWFF
    PSLWFF COMPWFF IN MIN MAX MIRROR PRED PREDICATES process array boolean integer real word word1
    bool signed unsigned extend resize sizeof uwconst swconst EX AX EF AF EG AG E F O G H X Y Z A U
    S V T BU EBF ABF EBG ABG case esac init union xnor self count abs max min
    FTSPEC PTSPEC INPUT STRUCT ENUM int float R
    """
)
"""What FRET's editor refuses in an expression unless it is in quotes. Its grammar does not reserve
them. Source: NASA FRET 3.1, `FretSemantics.js` (words of NuSMV, words of R2U2)."""

NOTATION = _words("F G H O R S U V X Y Z LAST TRUE FALSE xor")
"""The words of formulas: operators, constants, and the mark of the last tick."""

SMV = _words(
    """
    MODULE DEFINE MDEFINE CONSTANTS VAR IVAR FROZENVAR INIT TRANS INVAR SPEC CTLSPEC LTLSPEC PSLSPEC
    COMPUTE NAME INVARSPEC FAIRNESS JUSTICE COMPASSION ISA ASSIGN CONSTRAINT SIMPWFF CTLWFF LTLWFF
    PSLWFF COMPWFF COMPID IN MIN MAX MIRROR PRED PREDICATES process array of boolean integer real
    word word1 bool signed unsigned extend resize sizeof uwconst swconst EX AX EF AF EG AG E F O G H
    X Y Z A U S V T R W BU ABU EBU EBF ABF EBG ABG case esac mod next init union in xor xnor self
    TRUE FALSE count abs max min FUN ITYPE READ WRITE CONSTARRAY toint typeof floor clock cos exp ln
    pi sin tan time urandom noncontinuous always and assert before never not or until within
    inside outside first_run last_run over
    """
)
"""NuSMV 2.6 User Manual, 2.1 (reserved words); nuXmv User Manual; words of PSL; and the constants
of our module, which all modules of a file know."""

PRISM = _words(
    """
    A bool clock const csg ctmc C deadlock double dtmc E endinit endinvariant endmodule
    endobservables endplayer endrewards endsystem F false filter floor ceil formula func G global I
    idtmc imdp init int invariant label log ma max mdp min mod module nondeterministic observable
    observables of P Pmax Pmin player pomdp popta pow prob probabilistic pta R rate rewards Rmax
    Rmin round S smg stochastic system T true tptg U W X
    """
)
"""PRISM manual, The PRISM Language: key words, types of models, functions; the labels `init` and
`deadlock`; and what Storm's parser reserves beside them."""

DAFNY = _words(
    """
    abstract allocated allows array as assert assume bool break by calc case char class codatatype
    colemma const constructor continue copredicate datatype decreases downto else ensures exists
    expect export extends false field forall fresh from function ghost greatest hide hides if imap
    import in include inductive int invariant is iset iterator label labels least lemma locals map
    match method modifies modify module multiset nameonly nat new newtype null object old older
    opaque opened ORDINAL original predicate print protected provides reads real refines
    referrers replaceable requires return returns reveal reveals seq set static string then this
    trait true twostate type unchanged var where while witness yield yields
    Floor IsLimit IsNat IsSucc Items Keys Length Offset Values
    """,
    r"(?:array|bv|Length)\d+",
)
"""Dafny Reference Manual, 2.6.2 (reserved words), of versions 2.3 and 4; names of types, and of
their members: Dafny 2.3 ends in an exception where a field has one of those.
"""

C = _words(
    """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor
    bool break case catch char char8_t char16_t char32_t class co_await co_return co_yield compl
    concept const const_cast consteval constexpr constinit continue contract_assert decltype default
    delete do double dynamic_cast else eq enum explicit export extern false float for friend goto if
    inline int long mutable namespace new noexcept noreturn not not_eq nullptr operator or or_eq
    private protected public reflexpr register reinterpret_cast requires restrict return short
    signed sizeof static static_assert static_cast struct switch synchronized template this
    thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using
    virtual void volatile wchar_t while xor xor_eq

    E2BIG EACCES EADDRINUSE EADDRNOTAVAIL EADV EAFNOSUPPORT EAGAIN EALREADY EBADE EBADF EBADFD
    EBADMSG EBADR EBADRQC EBADSLT EBFONT EBUSY ECANCELED ECHILD ECHRNG ECOMM ECONNABORTED
    ECONNREFUSED ECONNRESET EDEADLK EDEADLOCK EDESTADDRREQ EDOM EDOTDOT EDQUOT EEXIST EFAULT EFBIG
    EHOSTDOWN EHOSTUNREACH EHWPOISON EIDRM EILSEQ EINPROGRESS EINTR EINVAL EIO EISCONN EISDIR EISNAM
    EKEYEXPIRED EKEYREJECTED EKEYREVOKED EL2HLT EL2NSYNC EL3HLT EL3RST ELIBACC ELIBBAD ELIBEXEC
    ELIBMAX ELIBSCN ELNRNG ELOOP EMEDIUMTYPE EMFILE EMLINK EMSGSIZE EMULTIHOP ENAMETOOLONG ENAVAIL
    ENETDOWN ENETRESET ENETUNREACH ENFILE ENOANO ENOBUFS ENOCSI ENODATA ENODEV ENOENT ENOEXEC ENOKEY
    ENOLCK ENOLINK ENOMEDIUM ENOMEM ENOMSG ENONET ENOPKG ENOPROTOOPT ENOSPC ENOSR ENOSTR ENOSYS
    ENOTBLK ENOTCONN ENOTDIR ENOTEMPTY ENOTNAM ENOTRECOVERABLE ENOTSOCK ENOTSUP ENOTTY ENOTUNIQ
    ENXIO EOF EOPNOTSUPP EOVERFLOW EOWNERDEAD EPERM EPFNOSUPPORT EPIPE EPROTO EPROTONOSUPPORT
    EPROTOTYPE ERANGE EREMCHG EREMOTE EREMOTEIO ERESTART ERFKILL EROFS ESHUTDOWN ESOCKTNOSUPPORT
    ESPIPE ESRCH ESRMNT ESTALE ESTRPIPE ETIME ETIMEDOUT ETOOMANYREFS ETXTBSY EUCLEAN EUNATCH EUSERS
    EWOULDBLOCK EXDEV EXFULL EXIT_FAILURE EXIT_SUCCESS
    BUFSIZ CLOCKS_PER_SEC FILENAME_MAX FOPEN_MAX HUGE_VAL HUGE_VALF HUGE_VALL L_tmpnam
    MATH_ERREXCEPT MATH_ERRNO MB_CUR_MAX MB_LEN_MAX NAN NULL ONCE_FLAG_INIT RAND_MAX SEEK_CUR
    SEEK_END SEEK_SET
    TIME_UTC TMP_MAX TSS_DTOR_ITERATIONS DECIMAL_DIG WEOF INFINITY I complex imaginary errno stdin
    stdout stderr math_errhandling assert offsetof signbit
    TRUE FALSE IN OUT ERROR near far small interface min max linux unix i386 arm mips sparc sun vax
    hpux sgi none
    """,
    r"""(?x)
    U?INT\w*_(?:MAX|MIN|C|WIDTH) | u?int\w*_t | (?:PTRDIFF|SIZE|SIG_ATOMIC|WCHAR|WINT)_(?:MAX|MIN)
    | [SU]?CHAR_(?:MAX|MIN|BIT) | U?(?:SHRT|INT|LONG|LLONG)_(?:MAX|MIN)
    | (?:PRI|SCN)[diouxX](?:8|16|32|64|MAX|PTR|(?:LEAST|FAST)\d+)
    | (?:FLT|DBL|LDBL)_(?:MANT_DIG|DIG|(?:MIN|MAX)(?:_10)?(?:_EXP)?|EPSILON|TRUE_MIN|DECIMAL_DIG
        |HAS_SUBNORM) | FLT_(?:ROUNDS|RADIX|EVAL_METHOD)
    | FE_(?:ALL_EXCEPT|DFL_ENV|DIVBYZERO|DOWNWARD|INEXACT|INVALID|OVERFLOW|TONEAREST|TOWARDZERO
        |UNDERFLOW|UPWARD) | FP_(?:INFINITE|NAN|NORMAL|SUBNORMAL|ZERO|ILOGB0|ILOGBNAN|FAST_FMA[FL]?)
    | M_(?:E|LOG2E|LOG10E|LN2|LN10|PI|PI_2|PI_4|1_PI|2_PI|2_SQRTPI|SQRT2|SQRT1_2)
    | LC_(?:ALL|COLLATE|CTYPE|MESSAGES|MONETARY|NUMERIC|TIME|ADDRESS|IDENTIFICATION
        |MEASUREMENT|NAME|PAPER|TELEPHONE)
    | ATOMIC_(?:(?:BOOL|CHAR|CHAR16_T|CHAR32_T|WCHAR_T|SHORT|INT|LONG|LLONG|POINTER)_LOCK_FREE
        |FLAG_INIT|VAR_INIT) | SIG_(?:DFL|ERR|IGN)
    | SIG(?:ABRT|ALRM|BUS|CHLD|CONT|FPE|HUP|ILL|INT|IO|KILL|PIPE|QUIT|SEGV|STOP|SYS|TERM|TRAP|TSTP
        |TTIN|TTOU|URG|USR1|USR2|VTALRM|WINCH|XCPU|XFSZ|CLD|IOT|POLL|PROF|PWR|RTMAX
        |RTMIN|STKFLT)
    | fretc_\w+ | FRETC_\w+
    """,
)
"""ISO C11, 6.4.1, and ISO C++20, 5.11 (key words); what the headers of ISO C and usual compilers
define as macros, for a header may follow any other; what our own header names; and `eq`, which has
a negation, `not_eq`."""

C_LIBRARY = _words(
    "aio atomic cnd fanotify fretc inotify mtx regex res sem",
    r"(?:pthread|posix_spawn|inet6)_\w+",
)
"""With `_init` behind them, functions of the C library; no name of our functions begins so."""

RUST = _words(
    """
    as async await break const continue crate dyn else enum extern false fn for if impl in let loop
    match mod move mut pub ref return self Self static struct super trait true type unsafe use where
    while abstract become box do final gen macro override priv try typeof unsized virtual yield
    """
)
"""The Rust Reference, Keywords: strict and reserved ones, of the editions up to 2024."""

JAVASCRIPT = _words(
    """
    arguments async await break case catch class const continue debugger default delete do else enum
    eval export extends false finally for function get if implements import in instanceof interface
    let new null of package private protected public return set static super switch this throw true
    try typeof undefined var void while with yield NaN Infinity globalThis
    """
)
"""ECMAScript 2025, 12.7.2; in our texts each name of the user has a prefix, `is_` or `v_`."""

JAVA = _words(
    """
    abstract assert boolean break byte case catch char class const continue default do double else
    enum extends final finally float for goto if implements import instanceof int interface long
    native new package private protected public return short static strictfp super switch
    synchronized this throw throws transient try void volatile while true false null _
    Truth
    """
)
"""The Java Language Specification, 3.9; and the type of inputs, which a field of its name hides."""

PYTHON = _words(
    """
    False None True and as assert async await break class continue def del elif else except finally
    for from global if import in is lambda nonlocal not or pass raise return try while with yield
    self every known is_possible tick rows row approximation certain possible first kept_first
    boolean Signals Marks previous weak_previous once historically since released since_from
    since_between released_between SATISFIED VIOLATED PENDING
    """
)
"""The Python Language Reference, 2.3.1; and names in our functions: their local variables and the
functions that they call."""

LUSTRE = _words(
    """
    and assert assume bool by check const contract current div diese else enum ensure extern false
    fby function guarantee if imported int int8 int16 int32 int64 is let map merge mod mode
    node nor not of operator or package param pre private provides real require returns step
    struct tel then to true type uint8 uint16 uint32 uint64 unsafe var weakly when with xor
    at the model needs body end
    """
)
"""Lustre V6 Reference Manual, 2.1; CoCoSpec; and what our reader does not take for a name."""

AJPF = _words("A E U R B G F I D P T ItD achieve perform True")
"""MCAPL's grammars of properties and of Gwendolen."""

AJPF_ACTIONS = AJPF | (
    "sum minus div times append toString print printstate printagentstate remove_shared "
    "assert_shared query substring".split()
)
"""What no action of an agent is called: MCAPL carries these out itself, with arguments that it
expects. A belief may have such a name."""

SPOT = _words("true false xor LAST", r"[FGMRUVWX].*|(?i:true|false|xor)")
"""Spot's grammar of LTL: such a name is in quotes there, for `Fault` would be `F ault`. In formulas
that Spot reads for us no name of the user stands (`compiler.logic.spot`)."""

TABLES = {
    "FRET": FRET,
    "notation": NOTATION,
    "SMV": SMV,
    "PRISM": PRISM,
    "Dafny": DAFNY,
    "C": C,
    "Rust": RUST,
    "JavaScript": JAVASCRIPT,
    "Java": JAVA,
    "Python": PYTHON,
    "Lustre": LUSTRE,
    "AJPF": AJPF,
    "Spot": SPOT,
}
