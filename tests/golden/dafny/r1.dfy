// R1: Stop when an obstacle is within 5 cm
// whenever too_close agilex_agent shall eventually satisfy stopped
//
// Accepted by Dafny 2.3 (`dafny /compile:0 r1.dfy`) and written for Dafny 4 (`dafny verify r1.dfy`).
// Made by fretc; every change makes it another file, of which nothing is known.

// Monitor -----------------------------------------------------------------------------------------
//
// The step of the monitor, and what it says after every number of ticks of every sequence of ticks,
// compared with the definition of the timing over the whole sequence.

// One tick: the propositions of the sentence.
datatype Tick = Tick(too_close: bool, stopped: bool)

predicate Condition(x: Tick)
{
  x.too_close
}

predicate Response(x: Tick)
{
  x.stopped
}

// A demand begins at tick t.
predicate Triggered(w: seq<Tick>, t: int)
  requires 0 <= t < |w|
{
  Condition(w[t])
}

// What the monitor counts. Broken: for ever.
datatype Demand = Demand(count: int, broken: bool)

function DemandStep(d: Demand, triggered: bool, q: bool): Demand
{
  Demand(if (d.count > 0 || triggered) && !q then 1 else 0, false)
}

// before: nothing has to be remembered of the condition.
datatype Monitor = Monitor(demand: Demand, before: bool)

function MonitorStep(m: Monitor, x: Tick): Monitor
{
  Monitor(DemandStep(m.demand, Condition(x), Response(x)), false)
}

// The monitor after the first k ticks.
function Run(w: seq<Tick>, k: int): Monitor
  requires 0 <= k <= |w|
  decreases k
{
  if k == 0 then Monitor(Demand(0, false), false)
  else MonitorStep(Run(w, k - 1), w[k - 1])
}

// The definition. Unanswered after k ticks: some trigger t < k has no response in t..k-1.
// No finite sequence violates; one that ends unanswered does not satisfy.
predicate Open(w: seq<Tick>, t: int, k: int)
  requires 0 <= t < k <= |w|
{
  Triggered(w, t) && forall u :: t <= u < k ==> !Response(w[u])
}

predicate Unanswered(w: seq<Tick>, k: int)
  requires 0 <= k <= |w|
{
  exists t :: 0 <= t < k && Open(w, t, k)
}

predicate Invariant(w: seq<Tick>, k: int)
  requires 0 <= k <= |w|
{
  var m := Run(w, k);
  var c := m.demand.count;
  (m.before <==> false) &&
  !m.demand.broken && 0 <= c <= 1 && (c == 1 <==> Unanswered(w, k))
}

lemma {:induction false} InvariantHolds(w: seq<Tick>, k: int)
  requires 0 <= k <= |w|
  ensures Invariant(w, k)
  decreases k
{
  if k > 0 {
    InvariantHolds(w, k - 1);
    var m := Run(w, k - 1);
    var c := m.demand.count;
    var t := k - 1;
    assert Run(w, k) == MonitorStep(m, w[t]);
    forall v | 0 <= v < t ensures Open(w, v, k) <==> Open(w, v, t) && !Response(w[t]) { }
    if Unanswered(w, t) && !Response(w[t]) {
      var v :| 0 <= v < t && Open(w, v, t);
      assert Open(w, v, k);
    }
    assert Triggered(w, t) && !Response(w[t]) ==> Open(w, t, k);
  }
}

lemma {:induction false} Exact(w: seq<Tick>, k: int)
  requires 0 <= k <= |w|
  ensures Run(w, k).demand.count > 0 <==> Unanswered(w, k)
{
  InvariantHolds(w, k);
}

// Interceptor -------------------------------------------------------------------------------------
//
// What it remembers and does, as [interceptor] of the bindings has it. Times are ticks of its timer;
// a timeout of 0 is no watchdog. `InterceptorStep` is the meaning, the class is what runs, and each
// method is shown to do what the step says.

const HOLD: int := 4
const STOP_TIMEOUT: int := 24
const SCAN_TIMEOUT: int := 0
const COMMAND_TIMEOUT: int := 10
const EVENT_DRIVEN: bool := false
const LATCHING: bool := false

// A Twist: m/s along x, y and z, rad/s around them.
datatype Velocity = Velocity(vx: real, vy: real, vz: real, wx: real, wy: real, wz: real)

const ZERO: Velocity := Velocity(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

// What comes in, and what goes to the wheels.
datatype Heard = StopHeard(requested: bool) | CommandHeard(command: Velocity) | ScanHeard | TimerRang

datatype Published = Nothing | Output(velocity: Velocity)

// held: ticks for which zero is still owed; ages: ticks since last heard, no more than the timeout.
datatype Interceptor = Interceptor(stop: bool, held: int, last: Velocity, stop_age: int, scan_age: int, command_age: int)

datatype After = After(state: Interceptor, published: Published)

function Older(age: int, timeout: int): int
{
  if age + 1 < timeout then age + 1 else timeout
}

predicate Expired(age: int, timeout: int)
{
  0 < timeout <= age
}

// Nothing but zero may go to the wheels.
predicate Halted(s: Interceptor)
{
  s.stop || s.held > 0 || Expired(s.stop_age, STOP_TIMEOUT) || Expired(s.scan_age, SCAN_TIMEOUT)
    || Expired(s.command_age, COMMAND_TIMEOUT)
}

predicate InRange(s: Interceptor)
{
  0 <= s.held <= HOLD && 0 <= s.stop_age <= STOP_TIMEOUT && 0 <= s.scan_age <= SCAN_TIMEOUT
    && 0 <= s.command_age <= COMMAND_TIMEOUT
}

// Nothing heard yet: every watchdog has run out.
function Initial(): Interceptor
{
  Interceptor(false, 0, ZERO, STOP_TIMEOUT, SCAN_TIMEOUT, COMMAND_TIMEOUT)
}

function Passed(s: Interceptor, v: Velocity): Published
{
  Output(if Halted(s) then ZERO else v)
}

function InterceptorStep(s: Interceptor, heard: Heard): After
{
  match heard
  case StopHeard(requested) =>
    var after := s.(stop := requested || (LATCHING && s.stop), held := if requested then HOLD else s.held, stop_age := 0);
    After(after, if requested && !EVENT_DRIVEN then Output(ZERO) else Nothing)
  case CommandHeard(command) =>
    var after := s.(last := command, command_age := 0);
    After(after, Passed(after, command))
  case ScanHeard =>
    After(s.(scan_age := 0), Nothing)
  case TimerRang =>
    if EVENT_DRIVEN then After(s, Nothing) else
      var older := s.(stop_age := Older(s.stop_age, STOP_TIMEOUT), scan_age := Older(s.scan_age, SCAN_TIMEOUT),
        command_age := Older(s.command_age, COMMAND_TIMEOUT));
      After(older.(held := if s.held > 0 then s.held - 1 else 0), Passed(older, s.last))
}

class CmdVelInterceptor {
  var stop: bool
  var held: int
  var last: Velocity
  var stop_age: int
  var scan_age: int
  var command_age: int

  function View(): Interceptor
    reads this
  {
    Interceptor(stop, held, last, stop_age, scan_age, command_age)
  }

  constructor ()
    ensures stop == false
    ensures View() == Initial()
  {
    stop := false;
    held := 0;
    last := ZERO;
    stop_age := STOP_TIMEOUT;
    scan_age := SCAN_TIMEOUT;
    command_age := COMMAND_TIMEOUT;
  }

  method StopCallback(requested: bool) returns (out: Published)
    modifies this
    ensures stop == (requested || (LATCHING && old(stop)))
    ensures After(View(), out) == InterceptorStep(old(View()), StopHeard(requested))
  {
    stop := requested || (LATCHING && stop);
    if requested {
      held := HOLD;
    }
    stop_age := 0;
    out := Nothing;
    if requested && !EVENT_DRIVEN {
      out := Output(ZERO);
    }
  }

  method CommandCallback(command: Velocity) returns (out: Published)
    modifies this
    ensures Halted(View()) ==> out == Output(ZERO)
    ensures !Halted(View()) ==> out == Output(command)
    ensures After(View(), out) == InterceptorStep(old(View()), CommandHeard(command))
  {
    last := command;
    command_age := 0;
    var halt := stop || held > 0 || 0 < STOP_TIMEOUT <= stop_age || 0 < SCAN_TIMEOUT <= scan_age
      || 0 < COMMAND_TIMEOUT <= command_age;
    out := Output(if halt then ZERO else command);
  }

  method ScanCallback() returns (out: Published)
    modifies this
    ensures After(View(), out) == InterceptorStep(old(View()), ScanHeard)
  {
    scan_age := 0;
    out := Nothing;
  }

  method TimerCallback() returns (out: Published)
    modifies this
    ensures After(View(), out) == InterceptorStep(old(View()), TimerRang)
  {
    out := Nothing;
    if !EVENT_DRIVEN {
      stop_age := if stop_age + 1 < STOP_TIMEOUT then stop_age + 1 else STOP_TIMEOUT;
      scan_age := if scan_age + 1 < SCAN_TIMEOUT then scan_age + 1 else SCAN_TIMEOUT;
      command_age := if command_age + 1 < COMMAND_TIMEOUT then command_age + 1 else COMMAND_TIMEOUT;
      var halt := stop || held > 0 || 0 < STOP_TIMEOUT <= stop_age || 0 < SCAN_TIMEOUT <= scan_age
        || 0 < COMMAND_TIMEOUT <= command_age;
      out := Output(if halt then ZERO else last);
      held := if held > 0 then held - 1 else 0;
    }
  }
}

lemma StaysInRange(s: Interceptor, heard: Heard)
  requires InRange(s)
  ensures InRange(Initial())
  ensures InRange(InterceptorStep(s, heard).state)
{
}

lemma OnlyZeroWhileHalted(s: Interceptor, heard: Heard)
  ensures var a := InterceptorStep(s, heard);
    Halted(a.state) ==> a.published == Nothing || a.published == Output(ZERO)
{
}

// The state after the first k things heard.
function Hear(s: Interceptor, h: seq<Heard>, k: int): Interceptor
  requires 0 <= k <= |h|
  decreases k
{
  if k == 0 then s else InterceptorStep(Hear(s, h, k - 1), h[k - 1]).state
}

// How often the timer rang among them.
function Rings(h: seq<Heard>, k: int): int
  requires 0 <= k <= |h|
  decreases k
{
  if k == 0 then 0 else Rings(h, k - 1) + (if h[k - 1].TimerRang? then 1 else 0)
}

// What is published at the thing heard after the first k.
function Said(s: Interceptor, h: seq<Heard>, k: int): Published
  requires 0 <= k < |h|
{
  InterceptorStep(Hear(s, h, k), h[k]).published
}

lemma {:induction false} HeldIsOwed(s: Interceptor, h: seq<Heard>, k: int)
  requires InRange(s) && 0 <= k <= |h|
  ensures InRange(Hear(s, h, k))
  ensures Hear(s, h, k).held >= s.held - Rings(h, k)
  decreases k
{
  if k > 0 {
    HeldIsOwed(s, h, k - 1);
    StaysInRange(Hear(s, h, k - 1), h[k - 1]);
  }
}

// After a request, whatever is heard next: nothing but zero until the timer has rung HOLD times.
lemma {:induction false} HoldLasts(s: Interceptor, h: seq<Heard>, k: int)
  requires InRange(s) && 0 <= k < |h|
  requires Rings(h, k) < HOLD
  ensures var requested := InterceptorStep(s, StopHeard(true)).state;
    Said(requested, h, k) == Nothing || Said(requested, h, k) == Output(ZERO)
{
  var requested := InterceptorStep(s, StopHeard(true)).state;
  StaysInRange(s, StopHeard(true));
  HeldIsOwed(requested, h, k);
}

lemma {:induction false} StopGrowsOld(s: Interceptor, h: seq<Heard>, k: int)
  requires InRange(s) && 0 <= k <= |h|
  requires forall i :: 0 <= i < k ==> !h[i].StopHeard?
  ensures Hear(s, h, k).stop_age >= (if Rings(h, k) < STOP_TIMEOUT then Rings(h, k) else STOP_TIMEOUT)
  decreases k
{
  if k > 0 {
    StopGrowsOld(s, h, k - 1);
  }
}

// Silence for the timeout halts.
lemma {:induction false} SilenceOfStopHalts(s: Interceptor, h: seq<Heard>, k: int)
  requires InRange(s) && 0 <= k <= |h|
  requires forall i :: 0 <= i < k ==> !h[i].StopHeard?
  requires Rings(h, k) >= STOP_TIMEOUT
  ensures Halted(Hear(s, h, k))
{
  StopGrowsOld(s, h, k);
}

lemma {:induction false} CommandGrowsOld(s: Interceptor, h: seq<Heard>, k: int)
  requires InRange(s) && 0 <= k <= |h|
  requires forall i :: 0 <= i < k ==> !h[i].CommandHeard?
  ensures Hear(s, h, k).command_age >= (if Rings(h, k) < COMMAND_TIMEOUT then Rings(h, k) else COMMAND_TIMEOUT)
  decreases k
{
  if k > 0 {
    CommandGrowsOld(s, h, k - 1);
  }
}

// Silence for the timeout halts.
lemma {:induction false} SilenceOfCommandHalts(s: Interceptor, h: seq<Heard>, k: int)
  requires InRange(s) && 0 <= k <= |h|
  requires forall i :: 0 <= i < k ==> !h[i].CommandHeard?
  requires Rings(h, k) >= COMMAND_TIMEOUT
  ensures Halted(Hear(s, h, k))
{
  CommandGrowsOld(s, h, k);
}

// The timer form speaks at every ring.
lemma SpeaksAtEveryTick(s: Interceptor)
  ensures InterceptorStep(s, TimerRang).published != Nothing
{
}

// Closed loop -------------------------------------------------------------------------------------
//
// Monitor, interceptor and any environment, for every bound, latency and braking. What is assumed:
//   - The safety function requests a stop while the monitor has an open demand. Of a demand that is
//     still open, a request is heard before the end of the tick that comes `reach` ticks after the one
//     that opened it.
//   - Messages of the safety function keep their order: after a request of a demand is heard
//     (`newer`), nothing that was sent before that demand is.
//   - When the wheels had nothing but zero at the ends of `braking` ticks in a row, the response holds.
// Everything else is free: when and what the planner commands, what is heard before, when the timer
// rings, and whether the response holds earlier. Before the first word of the interceptor the wheels turn.

datatype Event =
  Sampled(condition: bool, response: bool) |
  StopArrives(request: bool, newer: bool) |
  CommandArrives(velocity: Velocity) |
  ScanArrives |
  TimerRings

// moving: the wheels had something else than zero last; zeros: ends of ticks since; waiting: ticks since the
// open demand began; heard: a request of the open demand was heard.
datatype Loop = Loop(demand: Demand, before: bool, interceptor: Interceptor, moving: bool, zeros: int, waiting: int, heard: bool)

function LoopStart(): Loop
{
  Loop(Demand(0, false), false, Initial(), true, 0, 0, false)
}

function Hears(l: Loop, h: Heard): Loop
{
  var after := InterceptorStep(l.interceptor, h);
  if after.published == Nothing then l.(interceptor := after.state)
  else if after.published == Output(ZERO) then l.(interceptor := after.state, moving := false)
  else l.(interceptor := after.state, moving := true, zeros := 0)
}

// What has to have happened by the end of a tick.
function Ended(reach: nat, l: Loop): Loop
{
  var due := l.demand.count > 0 && !l.heard && l.waiting >= reach;
  var told := if due then Hears(l, StopHeard(true)).(heard := true) else l;
  told.(zeros := if told.moving then 0 else told.zeros + 1)
}

function LoopStep(reach: nat, braking: nat, l: Loop, e: Event): Loop
{
  match e
  case Sampled(condition, response) =>
    var ended := Ended(reach, l);
    var demand := DemandStep(l.demand, condition, response || ended.zeros >= braking);
    ended.(demand := demand, before := false,
      waiting := if l.demand.count > 0 && demand.count > 0 then l.waiting + 1 else 0,
      heard := ended.heard && demand.count > 0)
  case StopArrives(request, newer) =>
    if l.demand.count > 0 && (newer || l.heard) then Hears(l, StopHeard(true)).(heard := true)
    else Hears(l, StopHeard(request))
  case CommandArrives(velocity) => Hears(l, CommandHeard(velocity))
  case ScanArrives => Hears(l, ScanHeard)
  case TimerRings => Hears(l, TimerRang)
}

function LoopRun(reach: nat, braking: nat, e: seq<Event>, k: int): Loop
  requires 0 <= k <= |e|
  decreases k
{
  if k == 0 then LoopStart() else LoopStep(reach, braking, LoopRun(reach, braking, e, k - 1), e[k - 1])
}

predicate LoopInvariant(reach: nat, braking: nat, l: Loop)
{
  !l.demand.broken && l.zeros >= 0 && l.waiting >= 0 &&
  0 <= l.demand.count <= 1 &&
  (l.demand.count == 0 ==> !l.heard) &&
  (l.demand.count > 0 && !l.heard ==> l.waiting <= reach) &&
  (l.heard ==> l.interceptor.stop && !l.moving && l.waiting - reach <= l.zeros) &&
  (l.demand.count > 0 ==> l.waiting < reach + braking)
}

lemma {:induction false} LoopStepKeeps(reach: nat, braking: nat, l: Loop, e: Event)
  requires 1 <= braking
  requires LoopInvariant(reach, braking, l)
  ensures LoopInvariant(reach, braking, LoopStep(reach, braking, l, e))
{
}

// For every delay d = reach + braking: no demand stays open for d ticks, whatever happens.
lemma {:induction false} AnsweredInTime(reach: nat, braking: nat, e: seq<Event>, k: int)
  requires 1 <= braking
  requires 0 <= k <= |e|
  ensures var l := LoopRun(reach, braking, e, k);
    LoopInvariant(reach, braking, l) && (l.demand.count > 0 ==> l.waiting < reach + braking)
  decreases k
{
  if k > 0 {
    AnsweredInTime(reach, braking, e, k - 1);
    LoopStepKeeps(reach, braking, LoopRun(reach, braking, e, k - 1), e[k - 1]);
  }
}

// So late an answer can be: what is shown above is not empty.
lemma {:induction false} TheLatest(reach: nat, braking: nat, e: seq<Event>, k: int)
  requires 1 <= k <= |e| && k <= reach + braking
  requires forall i :: 0 <= i < k ==> e[i] == Sampled(true, false)
  requires 1 <= braking
  ensures var l := LoopRun(reach, braking, e, k);
    l.demand.count == 1 && l.waiting == k - 1 && (l.before <==> false) &&
    (if l.heard then k > reach + 1 && !l.moving && l.zeros == k - 1 - reach else k <= reach + 1 && l.moving && l.zeros == 0)
  decreases k
{
  if k > 1 {
    TheLatest(reach, braking, e, k - 1);
  } else {
    assert LoopRun(reach, braking, e, 0) == LoopStart();
  }
}
