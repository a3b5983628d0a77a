"""An agent that knows what it did and what it saw, and acts on the belief that follows."""

from __future__ import annotations

from numpy.typing import ArrayLike

from arkaq_edu._checks import array, distribution
from arkaq_edu.pomdp.belief import belief_update
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.value import ValueFunction


class BeliefAgent:
    """Keep the belief, and take the action that a value function holds best for it.

    Parameters
    ----------
    pomdp : POMDP
        The model of the world.
    value_function : ValueFunction
        What each belief is worth: of `solve_pomdp`, or `lower` of `solve_point_based`. One with a
        finite horizon recedes: every step is taken as if all of it were still to go.

    Attributes
    ----------
    belief : ndarray, shape (S,)
        What is known of the state.

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
        """Forget everything: begin at the start of the POMDP, or at another belief.

        Parameters
        ----------
        belief : array_like, shape (S,), optional
            Where to begin.

        Raises
        ------
        ValueError
            If `belief` is no distribution over the states.
        """
        if belief is None:
            belief = self.pomdp.start
        self.belief = distribution("belief", array("belief", belief, (self.pomdp.n_states,)))
        self._action: int | None = None

    def act(self) -> int:
        """Return the best action for the belief, and remember that it is taken."""
        self._action = self.value_function.action(self.belief)
        return self._action

    def observe(self, z: int) -> None:
        """Take in what was observed after the last action (equation 2.15).

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
