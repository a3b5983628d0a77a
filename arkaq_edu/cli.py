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
    """Teach a legged robot to walk to a ball."""
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
