"""Figures 4.3 and 4.4 line by line: as the thesis prints them, in short, and as `training` runs.

References
----------
Thesis, section 4.3, figures 4.3 and 4.4; `arkaq_edu.mdp.training` says why they cannot run as
printed.

Examples
--------
>>> [line.words for line in EXPLORATION.runs if line.event == "choose"]
['pick a at random, the untried in s first']
"""

from __future__ import annotations

from typing import NamedTuple


class Line(NamedTuple):
    """A line of a procedure as it runs.

    Attributes
    ----------
    indent : int
    words : str
    of : tuple of int
        The numbers of the printed lines that it stands for.
    changed : bool
        Whether it says something else than they do.
    event : str
        What the code is seen to do there.
    """

    indent: int
    words: str
    of: tuple[int, ...] = ()
    changed: bool = True
    event: str = ""


class Procedure(NamedTuple):
    """A procedure as it is printed, in short, by line with its indent; and as it runs."""

    name: str
    printed: tuple[tuple[int, str], ...]
    runs: tuple[Line, ...]


def _figure(name: str, table: str, pick: str, until: str, ours: str) -> Procedure:
    """Return figure 4.3 or 4.4: all but these words is the same in both."""
    loop = "while the state is still s"
    printed = (
        (0, "t = 0"),
        (0, table),
        (0, "while Q has not converged"),
        (1, pick),
        (1, "find the current state s"),
        (1, loop),
        (2, "do a"),
        (1, "take the reward r"),
        (1, "take the new state s'"),
        (1, "evaluate Q[s][a]"),
    )
    runs = (
        Line(0, table, (1,), changed=False),
        Line(0, "reset; find the state s", (4,), event="reset"),
        Line(0, until, (2,)),
        Line(1, ours, (3,), event="choose"),
        Line(1, f"{loop}, at most max_repeat times", (5,)),
        Line(2, "do a", (6,), changed=False, event="perform"),
        Line(1, "take the rewards r1 ... rk and the new state s'", (7, 8)),
        Line(1, "r = r1 + γ r2 + ... + γ^(k-1) rk"),
        Line(1, "Q[s][a] += α (r + γ^k max Q[s'] − Q[s][a])", (9,), event="update"),
        Line(1, "episode over: no Q[s'] above, and reset", event="maybe reset"),
        Line(1, "s = the state now"),
    )
    return Procedure(name, printed, runs)


#: Figure 4.3 and `arkaq_edu.mdp.explore`.
EXPLORATION = _figure(
    "exploration",
    table="a fresh table Q[S][A]",
    pick="pick a at random",
    until="until all was tried anew and changed Q by <= tol",
    ours="pick a at random, the untried in s first",
)

#: Figure 4.4 and `arkaq_edu.mdp.exploit`.
EXPLOITATION = _figure(
    "exploitation",
    table="the table Q[S][A] of the exploration",
    pick="pick a among those of high Q",
    until="until Q has long changed by <= tol",
    ours="draw a by exp(Q[s][a] / T), T falling",
)
