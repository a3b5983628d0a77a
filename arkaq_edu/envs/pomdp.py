"""Any POMDP as a Gymnasium environment: the state is hidden, the observations are shown."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from arkaq_edu._checks import integer, shown
from arkaq_edu.pomdp import POMDP, problem, read_pomdp


class POMDPEnv(gymnasium.Env[np.int64, np.int64]):
    """Act in any POMDP, of which only the observations are seen.

    The model decides what states, actions and observations there are. For the course's own, see
    `arkaq_edu.pomdp.problem`: "tiger" is the well-known one.

    ## Action space

    ``Discrete(A)``: the actions of the POMDP, by number; ``env.unwrapped.pomdp.actions`` names
    them.

    ## Observation space

    ``Discrete(Z + 1)``: the observations of the POMDP, and Z for "nothing yet". `reset` returns Z,
    because an observation follows an action, and at the start there was none.

    ## Rewards

    R(s, a), where s is the state in which the action is taken.

    ## Starting state

    Drawn from the `start` of the POMDP. With ``options={"state": s}`` in ``reset``, it is `s`.

    ## Episode end

    Terminated in a state that is never left and where nothing is earned (`ends` of the MDP). Most
    POMDPs have no such state; ``max_episode_steps`` of `gymnasium.make` sets a time limit, after
    which the episode is truncated.

    ## Information

    ``reset`` and ``step`` return the true `state`. The agent must not use it.

    ## Version history

    v0: first version.

    Parameters
    ----------
    pomdp : POMDP, str or path
        A model, the name of one of the course's problems (`arkaq_edu.pomdp.problem`), or the path
        of a file in Cassandra's format. A path ends in ``.pomdp``, in upper or lower case.

    Attributes
    ----------
    pomdp : POMDP
        The model, with the names of its states, actions and observations.

    References
    ----------
    Thesis 2.3 (figure 2.5).

    Examples
    --------
    >>> env = gymnasium.make("arkaq_edu:POMDP-v0", pomdp="tiger", max_episode_steps=100)
    >>> env.reset(seed=2)
    (np.int64(2), {'state': 0})
    >>> observation, reward, terminated, truncated, info = env.step(0)
    >>> env.unwrapped.pomdp.observations[observation], reward, info
    ('hear-left', -1.0, {'state': 0})
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    def __init__(self, pomdp: POMDP | Path | str) -> None:
        if isinstance(pomdp, Path) or (isinstance(pomdp, str) and pomdp.lower().endswith(".pomdp")):
            pomdp = read_pomdp(pomdp)
        elif isinstance(pomdp, str):
            pomdp = problem(pomdp)
        elif not isinstance(pomdp, POMDP):
            raise ValueError(f"pomdp must be a POMDP, a name or a path, got {pomdp!r}")
        self.pomdp = pomdp
        self.action_space = spaces.Discrete(pomdp.n_actions)
        self.observation_space = spaces.Discrete(pomdp.n_observations + 1)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.int64, dict[str, Any]]:
        """Start an episode, as the class describes."""
        super().reset(seed=None if seed is None else integer("seed", seed))
        states = np.arange(self.pomdp.n_states)
        if not options:
            self.state = int(self.np_random.choice(states, p=self.pomdp.start))
        elif (
            isinstance(options, dict)
            and set(options) == {"state"}
            and options["state"] in range(len(states))
        ):
            self.state = int(options["state"])
        else:
            raise ValueError(
                f"options must hold a state in [0, {len(states) - 1}], got {shown(options)}"
            )
        return np.int64(self.pomdp.n_observations), {"state": self.state}

    def step(self, action: np.int64) -> tuple[np.int64, float, bool, bool, dict[str, Any]]:
        """Take an action, as the class describes."""
        a = integer("action", action, 0, self.pomdp.n_actions - 1)
        s, z, r, terminated = self.pomdp.step(self.state, a, self.np_random)
        self.state = int(s)
        return np.int64(z), float(r), bool(terminated), False, {"state": self.state}
