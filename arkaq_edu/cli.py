"""The ``arkaq`` command."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from arkaq_edu import __version__
from arkaq_edu._paths import FIRST_PAGE, copy_course, course_folder, in_repository


class OneLineErrors(click.Group):
    """A command group that answers bad input with one line and exit status 2.

    Bad input is what click refuses, what the package refuses (``ValueError``) and what the
    operating system refuses (``OSError``: no such file, no permission). Anything else is a defect
    and keeps its traceback.

    Examples
    --------
    >>> from click.testing import CliRunner
    >>> answer = CliRunner().invoke(main, ["dance"])
    >>> answer.exit_code, answer.output
    (2, "arkaq: error: No such command 'dance'.\\n")
    """

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command line and leave with its exit status."""
        try:
            status = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.Abort:
            click.echo("arkaq: interrupted", err=True)
            status = 130
        except (click.ClickException, ValueError, OSError) as error:
            text = error.format_message() if isinstance(error, click.ClickException) else str(error)
            click.echo(f"arkaq: error: {' '.join(text.split())}", err=True)
            status = 2
        sys.exit(status)


@click.group("arkaq", cls=OneLineErrors, invoke_without_command=True)
@click.version_option(__version__, prog_name="arkaq")
@click.pass_context
def main(context: click.Context) -> None:
    """Teach a legged robot to walk to a ball, and to score."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@main.command()
@click.argument("folder", required=False, type=click.Path(file_okay=False, path_type=Path))
@click.option("--copy-only", is_flag=True, help="Copy the course and stop.")
@click.option("--no-browser", is_flag=True, help="Start JupyterLab, but open no browser.")
def lab(folder: Path | None, copy_only: bool, no_browser: bool) -> None:
    """Open the course in JupyterLab, in a FOLDER of your own.

    The course is copied to FOLDER (default: arkaq-course), and a file that is there already is
    never written over: run this again in the same folder to go on with your work, or after an
    upgrade to get what is new. In a clone of the repository, without a FOLDER, the repository's
    own notebooks are opened where they are.
    """
    if folder is None and (copy_only or not in_repository()):
        folder = Path("arkaq-course")
    if folder is not None:
        copied, kept = copy_course(folder)
        click.echo(f"{folder}: files copied: {len(copied)}, of yours kept: {len(kept)}")
        for name in kept:
            click.echo(f"  kept {name} (rename it and run this again to get the course's own)")
    if not copy_only:
        _start_jupyterlab((folder or course_folder()) / "notebooks", no_browser)


_seed = click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
_TASKS = ("approach-ball", "score-goal")
_goal_distance = click.option(
    "--goal-distance",
    type=click.Choice(["near", "far"]),
    default="near",
    show_default=True,
    help="score-goal: where the robot stands.",
)


@main.command()
@click.argument("task", type=click.Choice(_TASKS), default="approach-ball")
@click.option(
    "--vigilance", type=float, help="ART's vigilance.  [default: 0.1; goal: 0.06 near, 0.05 far]"
)
@click.option(
    "--kalman",
    type=click.Choice(["consistent", "thesis"]),
    default="consistent",
    show_default=True,
    help="approach-ball: the Kalman filter's settings.",
)
@_goal_distance
@click.option(
    "--out",
    type=click.Path(dir_okay=False, writable=True, path_type=Path),
    default="agent.npz",
    show_default=True,
    help="File for the agent; an interrupted training in it is taken up again.",
)
@_seed
def train(
    task: str, vigilance: float | None, kalman: str, goal_distance: str, out: Path, seed: int
) -> None:
    """Teach a robot a TASK, and say how well it does.

    TASK is approach-ball (the default) or score-goal.
    """
    from arkaq_edu import experiments

    if task == "score-goal":
        if kalman != "consistent":
            raise click.UsageError("--kalman is of approach-ball: the thesis gives none for a goal")
        goal: Any = experiments.goal
        agent = goal.train(seed, vigilance, goal_distance, checkpoint=out)
        shots = goal.shots(experiments.greedy(agent), 200, goal_distance, seed=10_000 + seed)
        done = f"goals in {shots.is_success.mean():.1%} of 200 fresh kicks"
    else:
        if goal_distance != "near":
            raise click.UsageError("--goal-distance is of score-goal")
        vigilance = 0.1 if vigilance is None else vigilance
        agent = experiments.train(seed, vigilance, sensing=kalman, checkpoint=out)
        judged = experiments.evaluate(experiments.greedy(agent), n=200, seed=10_000 + seed)
        done = (
            f"ball reached in {judged.is_success.mean():.1%} of 200 fresh approaches, "
            f"+50 in {judged.bonus.mean():.1%}"
        )
    click.echo(f"{out}: {agent.art.n_clusters_} states; {done}")


@main.command()
@click.argument("agent", default="approach-ball")
@click.option("--distance", type=float, default=3500.0, show_default=True, help="Ball's, mm.")
@click.option("--orientation", type=float, default=0.35, show_default=True, help="rad, left > 0")
@_goal_distance
@click.option(
    "--out",
    type=click.Path(dir_okay=False, writable=True, path_type=Path),
    help="A .gif, or an .html page with a player.  [default: walk.gif or shot.gif]",
)
@_seed
def watch(
    agent: str,
    distance: float,
    orientation: float,
    goal_distance: str,
    out: Path | None,
    seed: int,
) -> None:
    """Film a trained agent at work.

    AGENT is a file that `arkaq train` wrote, or approach-ball (the default) or score-goal: then it
    is the course's own.
    """
    from arkaq_edu import experiments
    from arkaq_edu.arkaq import Arkaq
    from arkaq_edu.figures.drawing.animation import save_shot, save_walk

    goal: Any = experiments.goal
    if agent == "approach-ball":
        who = experiments.load_agent()
    elif agent == "score-goal":
        who = goal.load_agent(goal_distance)
    else:
        who = Arkaq.load(agent)
    if who.task == "goal":
        out = out or Path("shot.gif")
        shot = goal.shoot(who, orientation, goal_distance, seed)
        save_shot(shot, out)
        turns = len(shot.table) - 2
        click.echo(f"{out}: {'a goal' if shot.is_success else 'a miss'} after {turns} turns")
    else:
        out = out or Path("walk.gif")
        way = experiments.walk(who, distance, orientation, seed)
        save_walk(way, out)
        end = "reached the ball" if way.is_success else "did not reach the ball"
        click.echo(f"{out}: {end} in {len(way.table) - 1} footstep cycles, reward {way.reward:g}")


@main.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default="reproduction",
    show_default=True,
    help="Folder for the page, the table and the agents.",
)
@click.option("--seeds", type=click.IntRange(1), default=20, show_default=True)
@click.option(
    "--approaches",
    type=click.IntRange(1),
    default=500,
    show_default=True,
    help="Approaches, and kicks, by which each policy is judged.",
)
@click.option("--jobs", type=int, default=-1, show_default=True, help="Processes; -1: all cores.")
def reproduce(out: Path, seeds: int, approaches: int, jobs: int) -> None:
    """Repeat the experiments of the thesis, over many seeds.

    Writes index.html, which opens offline, and results.csv. One seed takes about two minutes of
    one core. The trained agents are kept: call it again after an interruption, and it goes on
    where it was.
    """
    import matplotlib

    matplotlib.use("agg")
    from arkaq_edu.arkaq import Arkaq
    from arkaq_edu.experiments import agent_file, results
    from arkaq_edu.figures.gallery import FIGURES
    from arkaq_edu.figures.report import write_report

    table = results(seeds, approaches, folder=out, jobs=jobs)
    click.echo("drawing the figures")
    # The stream of the first seed is the one recorded for the course; its agent is in `out`.
    agent, goal_agent = (Arkaq.load(agent_file(out, kind, 0)) for kind in ("consistent", "near"))
    click.echo(write_report(out, table, FIGURES, agent=agent, goal_agent=goal_agent))


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


if __name__ == "__main__":
    main()
