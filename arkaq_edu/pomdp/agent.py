"""An agent that keeps a belief and acts on it."""

from __future__ import annotations

from numpy.typing import ArrayLike

from arkaq_edu._checks import distribution
from arkaq_edu.pomdp.belief import belief_update
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.value import ValueFunction


class BeliefAgent:
    """Keep the belief, and take the action that is best for it by a value function.

    Parameters
    ----------
    pomdp : POMDP
        The model of the world.
    value_function : ValueFunction
        The value of each belief: from `solve_pomdp`, or `lower` from `solve_point_based`. A finite
        horizon recedes: every action is chosen as if the whole horizon were still to go.

    Attributes
    ----------
    belief : ndarray, shape (S,)
        What is known about the state.

    Raises
    ------
    ValueError
        If the value function is over another number of states.

    References
    ----------
    Thesis 2.3 (figure 2.5): the state estimator and the policy.

    Examples
    --------
    >>> from arkaq_edu.pomdp import problem, solve_pomdp
    >>> tiger = problem("tiger")
    >>> agent = BeliefAgent(tiger, solve_pomdp(tiger))
    >>> for heard in (0, 0):
    ...     print(tiger.actions[agent.act()])
    ...     agent.observe(heard)
    listen
    listen
    >>> agent.belief.round(3), tiger.actions[agent.act()]
    (array([0.97, 0.03]), 'open-right')
    """

    def __init__(self, pomdp: POMDP, value_function: ValueFunction) -> None:
        n_states = value_function.alphas.shape[1]
        if n_states != pomdp.n_states:
            raise ValueError(
                f"value_function must be over {pomdp.n_states} states, got one over {n_states}"
            )
        self.pomdp, self.value_function = pomdp, value_function
        self.reset()

    def reset(self, belief: ArrayLike | None = None) -> None:
        """Go back to the belief at the start of the POMDP, or to another belief.

        Parameters
        ----------
        belief : array_like, shape (S,), optional
            The new belief.

        Raises
        ------
        ValueError
            If `belief` is not a distribution over the states.
        """
        if belief is None:
            belief = self.pomdp.start
        self.belief = distribution("belief", belief, (self.pomdp.n_states,))
        self._action: int | None = None

    def act(self) -> int:
        """Return the best action for the belief, and remember it for `observe`."""
        self._action = self.value_function.action(self.belief)
        return self._action

    def observe(self, z: int) -> None:
        """Update the belief with what was observed after the last action (equation 2.15).

        Parameters
        ----------
        z : int
            The observation.

        Raises
        ------
        ValueError
            If no action was taken, or `z` cannot follow it.
        """
        if self._action is None:
            raise ValueError("observe must follow act: an observation answers an action")
        self.belief = belief_update(self.pomdp, self.belief, self._action, z)
        self._action = None
