"""The automata of the thesis: each one small table, which the agent runs and a figure draws."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

DONE = "done"


@dataclass(frozen=True)
class Automaton:
    """States, and the events that lead from one to the next.

    Parameters
    ----------
    start : str
        The first state.
    table : mapping of (state, event) to state
        The next state. The automaton ends in the state "done".

    Examples
    --------
    >>> door = Automaton("shut", {("shut", "push"): "open", ("open", "leave"): "done"})
    >>> door.states
    ('shut', 'open')
    >>> door.run({"shut": lambda: "push", "open": lambda: "leave"})
    """

    start: str
    table: Mapping[tuple[str, str], str]

    @property
    def states(self) -> tuple[str, ...]:
        """All states but the last, in the order of the table."""
        return tuple(dict.fromkeys(state for state, _ in self.table))

    def run(self, work: Mapping[str, Callable[[], str]]) -> None:
        """Call the function of each state, which returns an event, until the table says "done"."""
        for _ in self.events(work):
            pass

    def events(self, work: Mapping[str, Callable[[], str]]) -> Iterator[tuple[str, str, str]]:
        """Run, and stop after each event: yield the state, its event, and the state that follows.

        Examples
        --------
        >>> door = Automaton("shut", {("shut", "push"): "open", ("open", "leave"): "done"})
        >>> next(door.events({"shut": lambda: "push"}))
        ('shut', 'push', 'open')
        """
        state = self.start
        while state != DONE:
            event = work[state]()
            worked, state = state, self.table[state, event]
            yield worked, event, state


# Figure 5.6. The thesis draws no end. Here the phase is over after a number of patterns.
SEGMENTATION = Automaton(
    "supervisor",
    {
        ("supervisor", "reset"): "observe",
        ("supervisor", "enough"): DONE,
        ("observe", "ball seen"): "network",
        ("observe", "no ball"): "unknown",
        ("unknown", "ask for reset"): "supervisor",
        ("network", "category updated"): "act",
        ("network", "category created"): "act",
        ("act", "moved"): "observe",
        ("act", "period over"): "supervisor",
    },
)

# Figure 5.15, and the loop of figures 4.3 and 4.4: first it explores, later it exploits.
Q_LEARNING = Automaton(
    "supervisor",
    {
        ("supervisor", "reset"): "identify",
        ("supervisor", "enough"): DONE,
        ("identify", "exploration"): "explore",
        ("identify", "exploitation"): "exploit",
        ("explore", "action chosen"): "act",
        ("exploit", "action chosen"): "act",
        ("act", "state remains"): "act",
        ("act", "state left"): "evaluate",
        ("act", "episode over"): "evaluate",
        ("evaluate", "next"): "identify",
        ("evaluate", "episode over"): "supervisor",
    },
)

# Figure 5.34. The robot only turns: a kick says nothing about where the goal can be.
GOAL_SEGMENTATION = Automaton(
    "supervisor",
    {
        ("supervisor", "reset"): "observe",
        ("supervisor", "enough"): DONE,
        ("observe", "goal seen"): "network",
        ("observe", "no goal"): "unknown",
        ("unknown", "ask for reset"): "supervisor",
        ("network", "category updated"): "turn",
        ("network", "category created"): "turn",
        ("turn", "turned"): "observe",
        ("turn", "period over"): "supervisor",
    },
)

# Figure 5.38, whose caption in the thesis says "segmentation". No action is held, since every
# turn changes the state. When the episode is over, the supervisor judges where the ball stopped.
GOAL_Q_LEARNING = Automaton(
    "supervisor",
    {
        ("supervisor", "reset"): "identify",
        ("supervisor", "enough"): DONE,
        ("identify", "exploration"): "explore",
        ("identify", "exploitation"): "exploit",
        ("explore", "action chosen"): "act",
        ("exploit", "action chosen"): "act",
        ("act", "turned"): "evaluate",
        ("act", "episode over"): "judge",
        ("judge", "goal"): "evaluate",
        ("judge", "no goal"): "evaluate",
        ("evaluate", "next"): "identify",
        ("evaluate", "episode over"): "supervisor",
    },
)
