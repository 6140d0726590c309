"""`fretc simulate`: record a simulated mission, or run a campaign of many."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from compiler.files.build_id import __version__
from fretc.terminal.options import (
    PATH,
    extras,
    format_option,
    jobs_option,
    output_option,
    path_option,
)
from fretc.terminal.output import (
    EXIT_OK,
    EXIT_VIOLATION,
    fail,
    not_written,
    print_status,
    write_outputs,
)
from fretc.terminal.progress import progress
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span

if TYPE_CHECKING:
    from simulation.nodes.safety import Agent
    from simulation.world.scenario import Scenario


@click.command(
    epilog=extras({"sim": "everything except --list", "live": "--agent"}),
)
@click.argument("scenarios", nargs=-1, type=PATH, metavar="[SCENARIO]...")
@output_option(
    help="MCAP file of the recording; with --campaign, folder for all recordings.",
)
@click.option(
    "--seed",
    default=1,
    show_default=True,
    type=click.IntRange(min=0),
    help="Seed of the random numbers.",
)
@click.option(
    "--duration",
    type=click.FloatRange(min=0, min_open=True),
    help="Time limit for the mission, in simulated seconds.  [default: that of the scenario]",
)
@click.option(
    "--encoding",
    type=click.Choice(("ros2", "ros1")),
    default="ros2",
    show_default=True,
    help="Message encoding of the recording.",
)
@path_option("--png", metavar="FILE", help="Also draw the mission as a picture.")
@path_option("--gif", metavar="FILE", help="Also draw the mission as an animation.")
@click.option(
    "--agent",
    "with_agent",
    is_flag=True,
    help="The safety function is the agent of R1, in MCAPL (environment variable AJPF_HOME).",
)
@click.option(
    "--campaign",
    type=click.IntRange(min=1),
    metavar="N",
    help="Run each scenario with N seeds, audit every recording, and print one table.",
)
@jobs_option
@format_option()
@click.option("--list", "listing", is_flag=True, help="List the scenarios and stop.")
def simulate(
    scenarios: Sequence[str],
    output: str | None,
    seed: int,
    duration: float | None,
    encoding: str,
    png: str | None,
    gif: str | None,
    with_agent: bool,
    campaign: int | None,
    jobs: int,
    output_format: str,
    listing: bool,
) -> None:
    """Simulate a robot's mission and record it as a log.

    SCENARIO is a name from `--list`, or a .toml file; `nominal` by default. It says which fault
    occurs. The robot's safety function is the monitor that fretc generates from R1.

    Example: fretc simulate obstacle-moved --seed 7 -o mission.mcap
    """
    from simulation.world.scenario import NOMINAL, load, names, without_agent

    if listing:
        for name in names():
            click.echo(f"{name:<22} {load(name).title}")
        return
    require_simulation()
    if campaign is not None:
        if png or gif or with_agent or duration is not None or encoding != "ros2":
            raise click.UsageError(
                "--campaign cannot be combined with --png, --gif, --agent, --duration or --encoding"
            )
        _count(
            [_scenario(n) for n in scenarios or without_agent()],
            seed,
            campaign,
            jobs,
            output,
            output_format,
        )
    if len(scenarios) > 1:
        raise click.UsageError("several scenarios need --campaign")
    if output is None:
        raise click.UsageError("missing option '--output'")
    scenario = _scenario(scenarios[0] if scenarios else NOMINAL)
    with _agent(scenario, with_agent) as agent:
        _record(scenario, output, seed, duration, encoding, {"png": png, "gif": gif}, agent)


@contextmanager
def _agent(scenario: Scenario, wanted: bool) -> Iterator[Agent | None]:
    """The running agent, if it is wanted."""
    if not wanted:
        _without_agent(scenario)
        yield None
        return
    from fretc.campaigns.agent import AgentError, agent
    from simulation.recording import TOPICS

    types = {topic.name: topic.type for topic in TOPICS}
    with ExitStack() as stack:
        try:
            running = stack.enter_context(agent(scenario, types))
        except AgentError as error:
            fail(diagnostic("agent_not_started", why=str(error)))
        except ModuleNotFoundError as error:
            fail(missing_extra("the agent needs", (str(error.name),), "live"))
        yield running


def _without_agent(scenario: Scenario) -> None:
    """Refuse a fault of the agent in a mission that has none."""
    if scenario.agent is not None:
        raise click.UsageError(f"the scenario {scenario.name} needs --agent")


def require_simulation() -> None:
    """Exit if the packages for the simulation are not installed."""
    from simulation import missing

    absent = missing()
    if absent:
        fail(missing_extra("the simulated robot needs", absent, "sim"))


def _scenario(name: str) -> Scenario:
    from simulation.mission import possible
    from simulation.world.scenario import ScenarioError, load

    try:
        scenario = load(name)
        possible(scenario)
        _known(scenario)
    except OSError as error:
        fail(_bad_scenario(name, error.strerror or str(error)))
    except (ScenarioError, ValueError) as error:
        fail(_bad_scenario(name, str(error)))
    return scenario


def _known(scenario: Scenario) -> None:
    """Check that the requirements with expected verdicts exist.

    Raises:
        ScenarioError: one does not exist.
    """
    from fretc.campaigns.experiment import project
    from simulation.world.scenario import ScenarioError

    ids = [requirement.id for requirement in project().formalized]
    for id, verdict in scenario.expect.verdicts.items():
        if id not in ids:
            where = f"`expect.{verdict.replace(' ', '_')}`"
            there = ", ".join(ids)
            raise ScenarioError(f"{where} names `{id}`, which is no requirement; there are {there}")


def _place(name: str, why: str) -> Span | None:
    """Position of the first key in the message; the start of the file if it is not found."""
    from compiler.files.text_files import read

    source = read(name) if name.endswith(".toml") else None
    if not isinstance(source, Source):
        return None
    *tables, key = why.partition("`")[2].partition("`")[0].split(".")
    text = source.text
    header = re.search(rf"^\s*\[+\s*{re.escape(tables[0])}\b", text, re.M) if tables else None
    begin = header.end() if header else 0
    match = re.compile(rf"(?<![\w-]){re.escape(key)}(?=\s*=)").search(text, begin) if key else None
    return source.span(*match.span()) if match else source.span(0, 0)


def _bad_scenario(name: str, why: str) -> Diagnostic:
    """F914."""
    return diagnostic("bad_scenario", _place(name, why), name=name, why=why)


def _file(out: str) -> Path:
    """Output path of a file; exits if it cannot be written."""
    from compiler.files.text_files import destination

    try:
        path = destination(Path(out))
    except OSError as error:
        fail(not_written(out, error.strerror or str(error)))
    if out == "-":
        fail(not_written(out, "a recording cannot be printed"))
    if path.exists() and not path.is_file():
        fail(not_written(out, "it is not a regular file"))
    _folder(path.parent, out)
    return path


def _folder(folder: Path, out: str) -> None:
    """Create the folder and its parents."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        fail(not_written(out, error.strerror or str(error)))


def _record(
    scenario: Scenario,
    out: str,
    seed: int,
    duration: float | None,
    encoding: str,
    pictures: Mapping[str, str | None],
    agent: Agent | None,
) -> None:
    from fretc.campaigns.campaign import intercepted
    from fretc.campaigns.experiment import safety_function
    from simulation.mission import record
    from simulation.recording import Encoding

    path = _file(out)
    images = {kind: _file(name) for kind, name in pictures.items() if name is not None}
    if len({path, *images.values()}) <= len(images):
        fail(not_written(out, "two outputs would go there"))
    limit = scenario.duration if duration is None else duration
    if not math.isfinite(limit):
        fail(not_written(out, "the duration of a mission must be finite"))
    decision = safety_function(scenario.safety.threshold)
    with progress(int(limit), "simulating") as show:
        try:
            mission = record(
                path,
                scenario,
                intercepted(scenario.interceptor),
                seed,
                decision,
                Encoding(encoding),
                limit,
                lambda now: show(int(now), f"{now:.0f} s"),
                {"fretc": __version__},
                agent,
            )
        except OSError as error:
            fail(not_written(out, error.strerror or str(error)))
    print_status(f"wrote {out}")
    if images:
        from simulation.picture import animate, draw

        painters = {"png": draw, "gif": animate}
        write_outputs({Path(str(pictures[kind])): painters[kind](mission) for kind in images})
    click.echo(
        f"{scenario.name}, seed {mission.seed}: {mission.duration:.1f} s, "
        f"{mission.goals_reached} of {mission.goals_total} goals, {len(mission.stops)} stops, "
        f"{mission.contacts} contacts, least clearance {mission.true_clearance * 100:.1f} cm, "
        f"{mission.messages} messages"
    )


def _count(
    scenarios: Sequence[Scenario],
    seed: int,
    count: int,
    jobs: int,
    out: str | None,
    output_format: str,
) -> None:
    """Run the campaign and exit."""
    from fretc.campaigns.campaign import campaign, table

    called = [scenario.name for scenario in scenarios]
    for scenario in scenarios:
        _without_agent(scenario)
    if len(set(called)) < len(called):
        raise click.UsageError("two scenarios have the same name")
    folder = Path(out) if out is not None else None
    if folder is not None:
        _folder(folder, str(out))
    total = len(scenarios) * count
    with progress(total, "simulating") as show:
        try:
            runs = campaign(
                scenarios,
                range(seed, seed + count),
                jobs,
                folder,
                lambda done: show(done, f"{done}/{total} missions"),
            )
        except OSError as error:
            fail(not_written(out or "a folder for temporary files", error.strerror or str(error)))
    if output_format == "json":
        click.echo(json.dumps([asdict(run) for run in runs], indent=2))
    else:
        click.echo(table(runs), nl=False)
    raise SystemExit(EXIT_VIOLATION if any(run.wrong for run in runs) else EXIT_OK)
