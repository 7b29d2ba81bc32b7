"""Commands that measure: evaluate."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from ...ontology.errors import check_simulator
from .common import exit_with, print_json, terminal
from .options import AsJson, Seed, app, example

_WHAT = "paper, situations, grasps, all-scenarios, random, noise, custom, facts, or module:Class."
Sim = Annotated[bool, typer.Option("--sim", help="Have a simulated robot carry out each command.")]
Scenes = Annotated[int | None, typer.Option(min=1, max=255, help="Scenes of the paper's run.")]
Drawn = Annotated[int | None, typer.Option(min=1, help="Learning scenarios of the random run.")]
Gap = Annotated[
    float | None,
    typer.Option(min=0.01, max=0.2, help="Least distance between things on a robot's table [m]."),
]
Trials = Annotated[int | None, typer.Option(min=1, help="Trials at each point of a noise curve.")]
Curves = Annotated[str | None, typer.Option(help="Noise curves, with commas between them.")]
Workers = Annotated[
    int | None,
    typer.Option(min=1, help="Cases at once, each in its process. Default: 1, or all of --ray."),
]
Ray = Annotated[str | None, typer.Option(help='A Ray cluster: address, "auto", or "local" (new).')]
Timeout = Annotated[float, typer.Option(min=0.1, help="Seconds until a case's worker is killed.")]
OutFolder = Annotated[Path | None, typer.Option(help="The folder for the journal and the results.")]
Reports = Annotated[
    list[Path] | None,
    typer.Option("--report", help="A file for the report: .html, .json or .csv; more than one."),
]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with the run that --out holds.")]
Cases = Annotated[bool, typer.Option("--cases", help="Print a table of all cases too.")]

OPTIONS = ("sim", "scenes", "scenarios", "gap", "poses", "trials", "curves", "file")  # if given


@app.command(epilog=example("evaluate paper --report paper.html"))
def evaluate(  # noqa: PLR0917 - every option is a parameter
    what: Annotated[str, typer.Argument(help=_WHAT)],
    data: Annotated[
        Path | None,
        typer.Argument(metavar="[FILE]", help="The file of facts or of a custom experiment."),
    ] = None,
    sim: Sim = False,
    scenes: Scenes = None,
    scenarios: Drawn = None,
    gap: Gap = None,
    poses: Annotated[int | None, typer.Option(min=1, help="Random poses of each grasp.")] = None,
    trials: Trials = None,
    curves: Curves = None,
    file: Annotated[Path | None, typer.Option(help="The YAML file of a custom experiment.")] = None,
    seed: Seed = 0,
    workers: Workers = None,
    ray: Ray = None,
    timeout: Timeout = 600.0,
    out: OutFolder = None,
    resume: Resume = False,
    report_to: Reports = None,
    show_cases: Cases = False,
    as_json: AsJson = False,
) -> None:
    """Repeat the paper's evaluation, and go beyond it.

    paper: 2 scenarios x 10 scenes x 15 commands. situations: all 256 scenes, 7,680 cases. grasps:
    8 objects x 2 contexts from random poses. all-scenarios: every set of rules that can be taught,
    by factorisation; --out keeps the certificate. random: random sets of rules. noise: accuracy
    under failing vision, hearing and teachers, as curves. custom: objects, norms and scenes of your
    own, from FILE. facts: a table of object, use and share, from FILE.
    """
    given = locals() | {"file": str(file or data or "")}
    if resume and out is None:
        raise typer.BadParameter("--resume needs --out, the folder of the run.")
    from ..evaluation.experiment import make_experiment
    from ..evaluation.reports.report import EvaluationReport, check_format, write_report
    from ..evaluation.runners.journal import RunJournal
    from ..evaluation.runners.runner import make_runner, run_experiment

    for path in report_to or ():
        check_format(path)
    options = {name: given[name] for name in OPTIONS if given[name]} | {"seed": seed}
    experiment = make_experiment(what, options)
    if getattr(experiment, "sim", False):  # a simulated robot carries out commands
        check_simulator()
    cases = experiment.cases()
    runner = make_runner(workers, ray, timeout_s=timeout)
    with RunJournal(out, experiment, cases, resume=resume) if out else nullcontext() as journal:
        console = terminal(stderr=True)
        runs = run_experiment(experiment, cases, runner=runner, journal=journal, console=console)
    report = EvaluationReport.from_runs(experiment, runs)
    for path in report_to or ():
        write_report(path, experiment, cases, report)
    if as_json:
        print_json(report.as_json())
    else:
        for table in (report.table() if show_cases else None, report.points()):
            if table is not None:
                terminal().print(table)
        for line in report.lines():
            terminal().print(line, markup=False, highlight=False, soft_wrap=True)
    exit_with(report.is_right)
