"""The code does what the running lines of figures 4.3 and 4.4 say, in their order."""

import re

import gymnasium
import pytest

from arkaq_edu.mdp import QLearner, exploit, explore
from arkaq_edu.mdp.procedures import EXPLOITATION, EXPLORATION


class Watched:
    """An environment of two states and a learner beside it: both write down what is done."""

    def __init__(self):
        self.seen = []
        self.env = gymnasium.make("FrozenLake-v1", is_slippery=True).unwrapped
        self.learner = QLearner(16, 4, alpha=0.5, gamma=0.9, rng=1)
        for name, event in (("reset", "reset"), ("step", "perform")):
            self.watch(self.env, name, event)
        self.watch(self.learner, "update", "update")
        for name in ("unvisited", "boltzmann"):
            self.watch(self.learner, name, "choose")

    def watch(self, thing, name, event):
        real = getattr(thing, name)

        def noted(*arguments, **options):
            self.seen.append(event)
            return real(*arguments, **options)

        setattr(thing, name, noted)


@pytest.mark.parametrize(
    ("procedure", "run"),
    [
        (EXPLORATION, lambda env, learner: explore(env, learner, max_backups=400, seed=1)),
        (
            EXPLOITATION,
            lambda env, learner: exploit(env, learner, temperature=5.0, max_backups=400, seed=1),
        ),
    ],
)
def test_the_code_does_what_the_running_lines_say_in_their_order(procedure, run):
    """The lines' events, outer ones once and inner ones over and over, are what is seen."""
    once, again = "", ""
    for line in procedure.runs:
        word = line.event.removeprefix("maybe ")
        many = "+" if line.indent == 2 else "?" if line.event != word else ""
        if line.event and line.indent == 0:
            once += f"{word} "
        elif line.event:
            again += f"(?:{word} ){many}"
    watched = Watched()
    run(watched.env, watched.learner)
    seen = "".join(f"{event} " for event in watched.seen)
    assert re.fullmatch(f"{once}(?:{again})+", seen)
    assert seen.count("reset") > 3 and "perform perform" in seen and "choose" in seen


def test_the_printed_exploitation_takes_an_action_before_it_knows_the_state_and_ours_does_not():
    printed = [words for _, words in EXPLOITATION.printed]
    assert printed.index("pick a among those of high Q") < printed.index("find the current state s")
    events = [line.event for line in EXPLOITATION.runs]
    assert events.index("reset") < events.index("choose")
