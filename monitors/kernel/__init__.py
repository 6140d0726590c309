"""The run time of every generated monitor; the text of these modules is copied into each of them.

Input is the truth values of propositions. Output is a verdict at each tick, and the outcome of a
whole trace. The modules use the standard library only, and import from each other by name only.
"""

from monitors.kernel.columns import Column as Column
from monitors.kernel.outcomes import Outcome as Outcome
from monitors.kernel.outcomes import evaluate as evaluate
from monitors.kernel.outcomes import stepped as stepped
from monitors.kernel.stepping import Monitor as Monitor
from monitors.kernel.verdicts import INCONCLUSIVE as INCONCLUSIVE
from monitors.kernel.verdicts import NO_DATA as NO_DATA
from monitors.kernel.verdicts import SATISFIED as SATISFIED
from monitors.kernel.verdicts import VACUOUS as VACUOUS
from monitors.kernel.verdicts import VIOLATED as VIOLATED
