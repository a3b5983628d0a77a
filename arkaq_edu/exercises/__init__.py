"""The exercises of the notebooks, by the name of what the student writes.

``exercises.turn.check(turn)`` tries an answer on fresh random cases. It prints praise, or raises
`ExerciseError` with what is wrong, and never gives the answer away. ``exercises.turn.hint()``
prints the next of three hints, and ``exercises.turn.solution()`` an answer.

What an exercise is: `arkaq_edu.exercises.exercise`. Each chapter has a module with the right
answers and the random cases, and beside it a TOML file with the words: praise, hints, known wrong
answers.

Examples
--------
>>> from arkaq_edu import exercises
>>> exercises.turn.check(lambda x, P, u, z, Q, R: (x + u, P + Q))
Traceback (most recent call last):
arkaq_edu.exercises.exercise.ExerciseError: the estimate is the prediction alone: the sighting \
changes nothing
>>> exercises.expected_reward.check(lambda b, R: b @ R)
Right: a mean over what the state may be. It is the true expected reward.
>>> exercises.expected_reward.solution()  # doctest: +ELLIPSIS
def expected_reward(b, R):
    ...
    return b @ R
"""

from arkaq_edu.exercises.approach import backup, boltzmann, reward
from arkaq_edu.exercises.art import choose, match, norm_r
from arkaq_edu.exercises.belief import correct, expected_reward, observation_chances, predict
from arkaq_edu.exercises.exercise import Exercise, ExerciseError
from arkaq_edu.exercises.field import ball, pose, scoring_chance
from arkaq_edu.exercises.goal import kicks_needed, state_bounds, worth
from arkaq_edu.exercises.kalman import combine, nis, turn
from arkaq_edu.exercises.learning import discounted_sum, epsilon_greedy, finite_sum, regret
from arkaq_edu.exercises.mdp import bellman, greedy, rate, td
from arkaq_edu.exercises.pomdp import best, lead, two_steps
from arkaq_edu.exercises.segmentation import nearest, present, scale

#: The exercises of each chapter, in their order.
CHAPTERS: dict[str, tuple[Exercise, ...]] = {
    "learning": (finite_sum, discounted_sum, epsilon_greedy, regret),
    "mdp": (bellman, greedy, td, rate),
    "belief": (predict, correct, observation_chances, expected_reward),
    "pomdp": (two_steps, best, lead),
    "kalman": (combine, turn, nis),
    "art": (match, choose, norm_r),
    "segmentation": (scale, nearest, present),
    "field": (pose, ball, scoring_chance),
    "approach": (reward, boltzmann, backup),
    "goal": (state_bounds, worth, kicks_needed),
}

__all__ = ["CHAPTERS", "Exercise", "ExerciseError", *(e.name for c in CHAPTERS.values() for e in c)]
