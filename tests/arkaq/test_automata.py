"""The tables of the automata, and what happens as they run."""

import gymnasium
import pytest

from arkaq_edu.arkaq import GOAL_Q_LEARNING, GOAL_SEGMENTATION, Q_LEARNING, SEGMENTATION, Automaton
from tests.arkaq.brief import GOAL_TASK, brief_agent, brief_scorer, near_task


def reachable(automaton):
    found, new = set(), {automaton.start}
    while new:
        found |= new
        new = {after for (state, _), after in automaton.table.items() if state in found} - found
    return found


@pytest.mark.parametrize(
    "automaton", [SEGMENTATION, Q_LEARNING, GOAL_SEGMENTATION, GOAL_Q_LEARNING]
)
def test_every_state_can_be_reached_and_can_reach_the_end(automaton):
    assert reachable(automaton) == {*automaton.states, "done"}
    for state in automaton.states:
        assert "done" in reachable(Automaton(state, automaton.table))


class Blinking(gymnasium.Wrapper):
    """Shows nothing in every ninth look."""

    looks = 0

    def blink(self, observation):
        self.looks += 1
        return observation * (self.looks % 9 > 0)

    def reset(self, **options):
        observation, info = self.env.reset(**options)
        return self.blink(observation), info

    def step(self, action):
        observation, *rest = self.env.step(action)
        return self.blink(observation), *rest


def test_the_tables_hold_just_what_can_happen(monkeypatch):
    tables = (SEGMENTATION, Q_LEARNING, GOAL_SEGMENTATION, GOAL_Q_LEARNING)
    happened = {id(automaton): set() for automaton in tables}
    events = Automaton.events

    def watch(self, work):
        def telling(state):
            def tell():
                event = work[state]()
                happened[id(self)].add((state, event))
                return event

            return tell

        return events(self, {state: telling(state) for state in work})

    monkeypatch.setattr(Automaton, "events", watch)
    brief_agent(env=near_task(patience=4))
    brief_scorer(env=Blinking(gymnasium.make(GOAL_TASK)))
    for automaton in tables:
        assert happened[id(automaton)] == set(automaton.table)
