"""The ``arkaq`` command."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from arkaq_edu import __version__
from arkaq_edu._copy import copy_course
from arkaq_edu._interrupts import LINE, STATUS, Interrupts
from arkaq_edu._paths import FIRST_PAGE


class OneLineErrors(click.Group):
    """A command group that answers bad input with one line and exit status 2.

    Bad input is what click, the package (``ValueError``) or the operating system (``OSError``: no
    such file, no permission) refuses. Anything else is a defect and keeps its traceback.

    Examples
    --------
    >>> from click.testing import CliRunner
    >>> answer = CliRunner().invoke(main, ["juggle"])
    >>> answer.exit_code, answer.output
    (2, "arkaq: error: No such command 'juggle'.\\n")
    """

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command line and exit with its status."""
        interrupts = Interrupts()
        try:
            with interrupts:
                status = super().main(*args, **{**kwargs, "standalone_mode": False})
        except Exception as error:  # an interrupt can come out of a library as any error
            status = STATUS if interrupts.came else _said(error)
        if status == STATUS or interrupts.came:
            click.echo(LINE, err=True)
        sys.exit(STATUS if interrupts.came else status)


def _said(error: Exception) -> int:
    """Say in one line what was wrong with the input, and return the status; or raise the error."""
    if isinstance(error, click.Abort):
        return STATUS
    if not isinstance(error, (click.ClickException, ValueError, OSError)):
        raise error
    text = error.format_message() if isinstance(error, click.ClickException) else str(error)
    click.echo(f"arkaq: error: {' '.join(text.split())}", err=True)
    return 2


@click.group("arkaq", cls=OneLineErrors, invoke_without_command=True)
@click.version_option(__version__, prog_name="arkaq")
@click.pass_context
def main(context: click.Context) -> None:
    """Teach a legged robot to walk to a ball, and to score."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@main.command()
@click.argument("folder", default="arkaq-course", type=click.Path(file_okay=False, path_type=Path))
@click.option("--copy-only", is_flag=True, help="Copy the course and stop.")
@click.option("--no-browser", is_flag=True, help="Start JupyterLab without a browser.")
def lab(folder: Path, copy_only: bool, no_browser: bool) -> None:
    """Open the course in JupyterLab, in a FOLDER of your own.

    The course is copied to FOLDER (default: arkaq-course), without the solutions. What you write
    there is never written over: run this again to continue your work, or after an upgrade to get
    what is new. If both you and the course have changed a page, the new one is put beside yours.
    """
    click.echo(f"{folder}: {copy_course(folder)}")
    if not copy_only:
        _start_jupyterlab(folder / "notebooks", no_browser)


@main.command()
@click.argument("name", default="vigilance")
@click.option(
    "--patterns",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="Your own patterns for the vigilance explorer: a csv with two columns of numbers.",
)
@click.option("--ip", default="127.0.0.1", show_default=True, help="The address to listen on.")
@click.option("--port", type=click.IntRange(1, 65535), default=8866, show_default=True)
@click.option("--no-browser", is_flag=True, help="Start the page without a browser.")
def explore(name: str, patterns: Path | None, ip: str, port: int, no_browser: bool) -> None:
    """Open an explorer on a page of its own.

    It is made for a lecture: large type, no code. NAME is vigilance (the default) or any other
    explorer; the page has links to all. It needs Voila: pip install "arkaq-edu[explore]".

    The address in the browser always names the setting that is shown: keep it to come back to the
    same picture. In the vigilance explorer you can open a csv of your own patterns (two columns of
    numbers), or drop it on the page, and download the centers.

    Only this computer can open the page, unless you say another --ip. Then anyone who reaches that
    address can, without a password.
    """
    from arkaq_edu.experiments.patterns import read_patterns
    from arkaq_edu.widgets import EXPLORERS

    if name not in EXPLORERS:
        raise click.BadParameter(f"must be one of {', '.join(EXPLORERS)}, got {name!r}")
    if patterns is not None:
        if name != "vigilance":
            raise click.UsageError("--patterns applies only to vigilance")
        read_patterns(patterns.read_text(encoding="utf-8-sig"))  # refused here, not in the page
    EXPLORERS[name]()  # what is compiled at first use is compiled now, not before the class
    _start_voila(name, patterns and patterns.resolve(), ip, port, no_browser)


_seed = click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
_TASKS = ("approach", "goal")
_goal_distance = click.option(
    "--goal-distance",
    type=click.Choice(["near", "far"]),
    help="Where the robot stands; applies only to goal.  [default: near]",
)


def _only(task: str, belongs_to: str, flag: str, **option: Any) -> dict[str, Any]:
    """Return an option if it was given (is not None); refuse it if it belongs to another task."""
    (value,) = option.values()
    if value is None:
        return {}
    if task != belongs_to:
        raise click.UsageError(f"{flag} applies only to {belongs_to}")
    return option


@main.command()
@click.argument("task", type=click.Choice(_TASKS), default="approach")
@click.option(
    "--vigilance",
    type=float,
    help="ART's vigilance.  [default: approach 0.1; goal 0.06 near, 0.05 far]",
)
@click.option(
    "--kalman",
    type=click.Choice(["consistent", "thesis"]),
    help="Settings of the Kalman filter; applies only to approach.  [default: consistent]",
)
@_goal_distance
@click.option(
    "--out",
    type=click.Path(dir_okay=False, writable=True, path_type=Path),
    default="agent.npz",
    show_default=True,
    help="File for the agent. An interrupted training continues from it.",
)
@_seed
def train(
    task: str,
    vigilance: float | None,
    kalman: str | None,
    goal_distance: str | None,
    out: Path,
    seed: int,
) -> None:
    """Train a robot on a TASK, and say how well it does.

    TASK is approach (walk to the ball, the default) or goal (score a goal).
    """
    from arkaq_edu import experiments
    from arkaq_edu.experiments.runs import FRESH_SEEDS

    sensing = _only(task, "approach", "--kalman", sensing=kalman)
    place = _only(task, "goal", "--goal-distance", goal_distance=goal_distance)
    problem: Any = getattr(experiments, task)
    agent = problem.train(seed, vigilance, **sensing, **place, checkpoint=out)
    table = problem.evaluate(problem.greedy(agent), 200, FRESH_SEEDS + seed, **place)
    click.echo(f"{out}: {agent.art.n_clusters_} states; {problem.describe(table)}")


@main.command()
@click.argument("agent", default="approach")
@click.option(
    "--distance",
    type=float,
    help="Distance of the ball (mm); applies only to approach.  [default: 3500]",
)
@click.option(
    "--orientation",
    type=float,
    default=0.35,
    show_default=True,
    help="Orientation of the ball or goal (rad, left is positive).",
)
@_goal_distance
@click.option(
    "--out",
    type=click.Path(dir_okay=False, writable=True, path_type=Path),
    help="A .gif, or an .html page with a player.  [default: walk.gif or shot.gif]",
)
@_seed
def watch(
    agent: str,
    distance: float | None,
    orientation: float,
    goal_distance: str | None,
    out: Path | None,
    seed: int,
) -> None:
    """Film a trained agent.

    AGENT is a file written by `arkaq train`. Or it is approach (the default) or goal, for the
    trained agent that comes with the course.
    """
    from arkaq_edu import experiments
    from arkaq_edu.arkaq import Arkaq
    from arkaq_edu.figures.drawing.animation import save_film

    saved = None if agent in _TASKS else Arkaq.load(agent)
    task = agent if saved is None else saved.task
    ball = _only(task, "approach", "--distance", distance=distance)
    place = _only(task, "goal", "--goal-distance", goal_distance=goal_distance)
    problem: Any = getattr(experiments, task)
    saved = saved or problem.load_agent(**place)
    episode = problem.record_episode(saved, orientation=orientation, seed=seed, **ball, **place)
    out = out or Path({"approach": "walk.gif", "goal": "shot.gif"}[task])
    save_film(episode, out)
    click.echo(f"{out}: {episode.outcome}")


@main.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default="reproduction",
    show_default=True,
    help="Folder for the page, the table and the agents.",
)
@click.option("--seeds", type=click.IntRange(1), help="Number of seeds.  [default: 30]")
@click.option(
    "--approaches",
    type=click.IntRange(1),
    help="Approaches, and kicks, that judge each policy.  [default: 500]",
)
@click.option("--jobs", type=int, default=-1, show_default=True, help="Processes; -1: all cores.")
@click.option("--quick", is_flag=True, help="A rehearsal in a minute: one seed, little training.")
def reproduce(out: Path, seeds: int | None, approaches: int | None, jobs: int, quick: bool) -> None:
    """Repeat the experiments of the thesis, and judge its numbers.

    Writes index.html, which opens offline; results.csv, a row for every number and claim with a
    verdict; runs.csv, every value of every seed; curves.csv, goals against kicks; and run.json,
    with versions, settings and times. Agents and measurements are kept as they are done: after an
    interruption, call it again to continue.
    """
    from arkaq_edu.arkaq import Arkaq
    from arkaq_edu.experiments import agent_file, judge, measure
    from arkaq_edu.experiments.reproduce import QUICK, write
    from arkaq_edu.experiments.runs import Plan
    from arkaq_edu.figures.errata import plot_count_search
    from arkaq_edu.figures.gallery import FIGURES
    from arkaq_edu.figures.report import SEARCH, write_report

    seeds, approaches = seeds or (1 if quick else 30), approaches or (20 if quick else 500)
    plan = Plan(out, approaches, *(QUICK if quick else ()))
    measured = measure(seeds, plan, jobs)
    write(out, measured, {"seeds": seeds, **plan.settings()})
    # The stream of the first seed is the one recorded for the course; its agents are in `out`.
    page = write_report(
        out,
        judge(measured.runs),
        FIGURES | {SEARCH: plot_count_search},
        note="A rehearsal with little training: its verdicts mean nothing." if quick else "",
        jobs=jobs,
        progress=True,
        agent=Arkaq.load(agent_file(out, "approach", "consistent", 0)),
        goal_agent=Arkaq.load(agent_file(out, "goal", "near", 0)),
        study=measured.curves,
    )
    click.echo(page)


@main.command()
@click.argument("place", nargs=-1, required=True)
@click.option("--all", "everything", is_flag=True, help="Name every function, test and notebook.")
def trace(place: tuple[str, ...], everything: bool) -> None:
    """Find the code and the tests of a PLACE in the thesis.

    PLACE is the number of an equation, a figure or a section, such as 2.47, 5.16 or 4.2.2. Where
    two have the same number, say which: figure 2.1. A row of the errata is errata row 12.
    """
    from arkaq_edu.trace import in_words
    from arkaq_edu.trace import trace as find

    found = find(" ".join(place))
    click.echo(in_words(found, len(found) + 1000) if everything else in_words(found))


@main.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="Folder for the cells, the table and the picture.",
)
@click.option("--jobs", type=int, default=-1, show_default=True, help="Processes; -1: all cores.")
@click.option("--cluster", metavar="ADDRESS", help="The scheduler of a Dask cluster to run on.")
def study(file: Path, out: Path, jobs: int, cluster: str | None) -> None:
    """Run all combinations of settings in a TOML FILE.

    environment.md shows what FILE may say, also with parts and tasks of your own; the settings are
    listed in help(arkaq_edu.experiments.study).

    Writes results.csv and results.png. Each finished cell is kept, so an interrupted study
    continues when you call it again, and one with more values or seeds runs only what is new.
    """
    import matplotlib

    matplotlib.use("agg")
    from arkaq_edu._files import replacing
    from arkaq_edu.experiments import read_plan, study
    from arkaq_edu.figures import plot_study

    plan = read_plan(file)
    sys.path.insert(0, str(file.resolve().parent))  # parts of one's own stand beside the file
    with _workers(cluster, jobs, file.resolve().parent) as workers:
        try:
            table = study(**plan, folder=out, jobs=workers)
        except RuntimeError as failed:
            click.echo("\n".join(getattr(failed.__cause__, "__notes__", [])), err=True)
            raise click.ClickException(f"{failed} (the others are in {out})") from failed
    with replacing(out / "results.png") as fresh:
        plot_study(table).ax[0].figure.savefig(fresh, dpi=150)
    click.echo(f"{out / 'results.csv'}: {len(table)} rows, drawn in {out / 'results.png'}")


@contextmanager
def _workers(cluster: str | None, jobs: int, folder: Path) -> Iterator[Any]:
    """Yield a number of processes, or a Dask cluster that knows the modules in a folder."""
    if cluster is None:
        yield jobs
        return
    try:
        from dask.distributed import Client
    except ImportError:
        raise click.UsageError("--cluster needs Dask: pip install 'arkaq-edu[cluster]'") from None
    with Client(cluster) as client:
        client.get_versions(check=True, packages=["arkaq_edu"])
        for module in sorted(folder.glob("*.py")):
            client.upload_file(str(module), load=False)
        yield client.get_executor(pure=False)


@main.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
def release(out: Path) -> None:
    """Write what a teacher hands out to the folder OUT.

    OUT must be new or empty. OUT/student is the course without solutions, OUT/teacher.zip has the
    solutions and the answers to the predictions, and OUT/nbgrader is a course folder for nbgrader.
    See TEACHING.md.
    """
    from arkaq_edu.release import release

    for line in release(out):
        click.echo(line)


@main.command()
@click.argument("out", default="slides", type=click.Path(file_okay=False, path_type=Path))
def slides(out: Path) -> None:
    """Write each chapter as slides for a lecture.

    OUT is the folder for the pages (default: slides).
    """
    from arkaq_edu.slides import slides

    for page in slides(out):
        click.echo(page)


@main.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
def site(out: Path) -> None:
    """Write the whole course as web pages.

    They open from a disk and from any web server, without Python; the pictures with sliders are
    alive there. OUT must be new, empty, or an earlier site. It needs Sphinx:
    pip install "arkaq-edu[site]".
    """
    try:
        import sphinx  # noqa: F401
    except ImportError:
        words = 'the site needs Sphinx, which is not installed: pip install "arkaq-edu[site]"'
        raise click.ClickException(words) from None
    from arkaq_edu.site.build import site

    for line in site(out):
        click.echo(line)


def _start_jupyterlab(folder: Path, no_browser: bool) -> None:
    from jupyterlab.labapp import main as jupyterlab

    options = [
        f"--ServerApp.root_dir={folder.resolve()}",
        f"--LabApp.default_url=/lab/tree/{FIRST_PAGE}",
        "--allow-root",  # in a container there is often no other user
    ]
    if no_browser:
        options.append("--no-browser")
    jupyterlab(options)


def _start_voila(name: str, patterns: Path | None, ip: str, port: int, no_browser: bool) -> None:
    import tempfile

    import nbformat

    try:
        from voila.app import main as voila
    except ImportError:
        words = 'this page needs Voila, which is not installed: pip install "arkaq-edu[explore]"'
        raise click.ClickException(words) from None
    code = (
        f"from arkaq_edu.widgets.page import visit\nvisit({name!r}, {patterns and str(patterns)!r})"
    )
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "explore.ipynb"
        nbformat.write(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)]), page)
        options = [
            str(page),
            f"--Voila.ip={ip}",
            f"--port={port}",
            "--show_tracebacks=True",
            # Voila's own pages cannot send the token that this check wants when they are closed,
            # and so leave their kernels behind. What it guards is bound to a kernel's secret id.
            "--Voila.tornado_settings={'disable_check_xsrf': True}",
            # Where a page vanishes without a word (a crash, a cut cable) its kernel goes later.
            "--MappingKernelManager.cull_idle_timeout=120",
            "--MappingKernelManager.cull_interval=60",
        ]
        if no_browser:
            options.append("--no-browser")
        voila(options)


if __name__ == "__main__":
    main()
