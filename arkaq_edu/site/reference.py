"""The reference: a page for each room of the package, and one for each environment."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import gymnasium
import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from arkaq_edu import envs
from arkaq_edu.figures.pomdp import plot_policy_graph
from arkaq_edu.pomdp import problem, solve_pomdp

#: The rooms with a page of their own, from the ground up, and their titles.
ROOMS = {
    "kalman": "The Kalman filter", "art": "Adaptive resonance",
    "mdp": "Decisions and reinforcement learning", "pomdp": "Decisions in a hidden world",
    "field": "The field and the robot", "arkaq": "The agent", "envs": "Gymnasium environments",
    "experiments": "The experiments", "figures": "The figures", "widgets": "The explorers",
    "exercises": "The exercises",
}  # fmt: skip

Member = tuple[str, Any]


def members(module: ModuleType) -> list[Member]:
    """Return the public classes, functions and data of a module, no modules.

    Examples
    --------
    >>> import arkaq_edu.kalman.walk
    >>> [name for name, _ in members(arkaq_edu.kalman.walk)][:2]
    ['Walk', 'simulated_walk']
    """
    names = getattr(module, "__all__", None)
    if names is None:
        names = [name for name, value in vars(module).items() if _own(module, name, value)]
    values = [(name, getattr(module, name)) for name in names]
    return [(name, value) for name, value in values if not inspect.ismodule(value)]


def _own(module: ModuleType, name: str, value: Any) -> bool:
    public = not name.startswith("_") and (inspect.isclass(value) or inspect.isroutine(value))
    return public and getattr(value, "__module__", "") == module.__name__


def modules(room: str) -> Iterator[tuple[ModuleType, list[Member]]]:
    """Yield a room and its modules, with what is documented there: each thing once."""
    seen: set[int] = set()
    package = importlib.import_module(f"arkaq_edu.{room}")
    names = [package.__name__] + [
        found.name
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
        if not found.name.split(".")[-1].startswith("_")
    ]
    for name in names:
        module = importlib.import_module(name)
        fresh = [(key, value) for key, value in members(module) if id(value) not in seen]
        seen |= {id(value) for _, value in fresh}
        if fresh or name == package.__name__:
            yield module, fresh


def documented() -> dict[tuple[str, str], str]:
    """Return under which name everything is documented, by its file and its own name.

    Examples
    --------
    >>> documented()["kalman/filter.py", "KalmanFilter.predict"]
    'arkaq_edu.kalman.KalmanFilter.predict'
    """
    found = {}
    root = Path(__file__).parents[1]
    for room in ROOMS:
        for module, own in modules(room):
            for name, value in own:
                where = inspect.unwrap(value) if inspect.isroutine(value) else value
                if not (inspect.isclass(where) or inspect.isroutine(where)):
                    continue
                file = Path(str(inspect.getsourcefile(where))).relative_to(root).as_posix()
                full = f"{module.__name__}.{name}"
                found[file, where.__qualname__] = full
                for method in vars(where) if inspect.isclass(where) else ():
                    found[file, f"{where.__qualname__}.{method}"] = f"{full}.{method}"
    return found


def write_reference(folder: Path) -> None:
    """Write a page for each room, and the page that leads to them."""
    folder.mkdir()
    for room in ROOMS:
        (folder / f"{room}.md").write_text(_room(room), encoding="utf-8")
    rows = "\n".join(
        f"| [{title}]({room}.md) | `arkaq_edu.{room}` | {_first_sentence(room)} |"
        for room, title in ROOMS.items()
    )
    (folder / "index.md").write_text(
        "# Reference\n\nUnits everywhere: millimeters, radians, seconds, grams. Orientation is "
        "positive to the left. Each room of the package imports only from those above it.\n\n"
        f"| page | import | what it is |\n|---|---|---|\n{rows}\n\n"
        "```{toctree}\n:hidden:\n\n" + "\n".join(ROOMS) + "\n```\n",
        encoding="utf-8",
    )


def _first_sentence(room: str) -> str:
    docstring = importlib.import_module(f"arkaq_edu.{room}").__doc__ or ""
    return re.split(r"(?<=\.)\s", docstring.strip().split("\n\n")[0].replace("\n", " "))[0]


def _room(room: str) -> str:
    parts = [f"# {ROOMS[room]}\n"]
    if room == "envs":
        parts.append("What each task is: [](../environments/index.md).\n")
    for module, own in modules(room):
        name = module.__name__
        if name != f"arkaq_edu.{room}":
            parts.append(f"## {name.removeprefix('arkaq_edu.')}\n")
        parts.append(_rst(f".. automodule:: {name}", f".. currentmodule:: {name}"))
        listed = [key for key, value in own if _kind(value) != "data"]
        if len(listed) > 1:
            parts.append(_rst(".. autosummary::", "   :nosignatures:", "", *(
                f"   {key}" for key in listed
            )))  # fmt: skip
        parts += [_rst(f".. currentmodule:: {name}", *_directive(*each)) for each in own]
    return "\n".join(parts)


def _rst(*lines: str) -> str:
    return "```{eval-rst}\n" + "\n".join(lines) + "\n```\n"


def _kind(value: Any) -> str:
    if inspect.isclass(value):
        return "exception" if issubclass(value, BaseException) else "class"
    return "function" if inspect.isroutine(value) or hasattr(value, "__wrapped__") else "data"


def _directive(name: str, value: Any) -> list[str]:
    kind = _kind(value)
    lines = [f".. auto{kind}:: {name}"]
    if kind in ("class", "exception"):
        lines.append("   :members:")
    if kind == "data":
        lines.append("   :no-value:")
    return lines


def plain_docstring(
    app: Any, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Prepare a docstring for numpydoc; a hook of Sphinx's autodoc.

    The part in Markdown of an environment's docstring goes: it has a page of its own. The sections
    of a module become plain headings.

    Examples
    --------
    >>> lines = ["A room.", "", "Examples", "--------", ">>> 1"]
    >>> plain_docstring(None, "module", "", None, None, lines)
    >>> lines
    ['A room.', '', '.. rubric:: Examples', '', '>>> 1']
    """
    if any(line.startswith("## ") for line in lines):
        lines[1:] = ["", *lines[_numpydoc(lines) :]]
    for i, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")) and "`" not in line:
            # Plain text where reStructuredText sees more: |a - b|, n_features_in_.
            lines[i] = re.sub(r"\||(?<=\w)_(?=,?\))", r"\\\g<0>", line)
    if what == "module":
        for i, line in enumerate(lines[1:], 1):
            if re.fullmatch("-{4,}", line):
                lines[i - 1 : i + 1] = [f".. rubric:: {lines[i - 1]}", ""]


def _numpydoc(lines: list[str]) -> int:
    """Return the line at which the first section of numpydoc begins."""
    return next(i for i, line in enumerate(lines[1:]) if line.startswith("----"))


def write_environments(folder: Path, pictures: Path) -> None:
    """Write a page for each environment, and the page that leads to them."""
    folder.mkdir()
    rows = []
    for name in environments():
        kind = envs_class(name)
        text = inspect.getdoc(kind) or ""
        lines = text.splitlines()
        told = "\n".join(lines[: _numpydoc(lines)]) if "## " in text else lines[0]
        page = [f"# {name}\n"]
        file = f"{name}.png"
        seen = _photograph(name, pictures / file)
        page.append(f"![{seen}](../_static/pictures/{file})\n")
        [made, *_] = re.findall(r"env = gymnasium.make\(.*\)", text)
        page += [f"```python\n{made}\n```\n", told, ""]
        page.append("## Arguments\n")
        page.append(_rst(".. currentmodule:: arkaq_edu.envs", f".. autoclass:: {kind.__name__}",
                         "   :no-index:"))  # fmt: skip
        (folder / f"{name}.md").write_text("\n".join(page), encoding="utf-8")
        rows.append(f"| [{name}]({name}.md) | {lines[0]} |")
    (folder / "index.md").write_text(
        "# Environments\n\nThe tasks of the course are Gymnasium environments. Any agent and any "
        "library that knows Gymnasium can use them.\n\n| environment | task |\n|---|---|\n"
        + "\n".join(rows)
        + "\n\n```{toctree}\n:hidden:\n\n"
        + "\n".join(environments())
        + "\n```\n",
        encoding="utf-8",
    )


def environments() -> list[str]:
    """Return the names of the course's environments.

    Examples
    --------
    >>> environments()
    ['BallApproach-v0', 'POMDP-v0', 'ScoreGoal-v0']
    """
    specs = gymnasium.registry.values()
    return [spec.id for spec in specs if str(spec.entry_point).startswith("arkaq_edu.")]


def envs_class(name: str) -> type[gymnasium.Env]:
    """Return the class of an environment.

    Examples
    --------
    >>> envs_class("POMDP-v0").__name__
    'POMDPEnv'
    """
    entry = gymnasium.spec(name).entry_point
    return getattr(envs, str(entry).split(":")[1])


def _photograph(name: str, file: Path) -> str:
    """Make the picture of an environment, and say what it shows."""
    if name == "POMDP-v0":  # it has nothing to be seen from above
        tiger, fig = problem("tiger"), Figure(layout="constrained")
        plot_policy_graph(solve_pomdp(tiger), tiger, fig.subplots())
        fig.savefig(file, dpi=144, bbox_inches="tight")
        return "The tiger as POMDP-v0: what to do after each observation, from the start on"
    env = gymnasium.make(name, render_mode="rgb_array")
    env.reset(seed=0)
    Image.fromarray(np.asarray(env.render())).save(file)
    env.close()
    return f"{name}, from above"
