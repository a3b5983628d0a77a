"""Run the benchmarks: ``make bench``, or one room: ``make bench ROOM=kalman``."""

from __future__ import annotations

import importlib
from pathlib import Path

import click

from benchmarks.case import Case, Figure, Growth, compared, figured, grown
from benchmarks.report import shown, write

ROOMS = "kalman", "art", "mdp", "pomdp", "field", "reproduction", "widgets"


@click.command(help=__doc__)
@click.argument("rooms", nargs=-1, type=click.Choice(ROOMS))
@click.option(
    "--output", type=click.Path(path_type=Path), default=Path("build/benchmarks"), show_default=True
)
def main(rooms: tuple[str, ...], output: Path) -> None:
    """Measure the rooms, all of them if none is named, and write the report."""
    rows, curves = [], []
    for room in rooms or ROOMS:
        for item in importlib.import_module(f"benchmarks.{room}").cases():
            if isinstance(item, Case):
                found = list(compared(room, item))
            elif isinstance(item, Figure):
                found = [figured(room, item)]
            elif isinstance(item, Growth):
                row, curve = grown(room, item)
                found = [row]
                curves.append(curve)
            for row in found:
                ratio = "" if row.ratio != row.ratio else f"ratio {row.ratio:8.3g}"
                click.echo(
                    f"{row.room:13}{row.work[:52]:54}{row.who[:32]:34}{shown(row)[:44]:46}{ratio:16}"
                    f"{row.wanted} {row.met}"
                )
            rows += found
    write(rows, curves, output)
    click.echo(f"The report is {output / 'index.html'}")


if __name__ == "__main__":
    main()
