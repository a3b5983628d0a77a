"""The exercises of the notebooks, by the name of what the student writes.

``turn = exercises.turn.check(turn)`` tries an answer on fresh random cases. It prints praise, or
what is wrong without giving the answer away, and returns the function to go on with: the student's
if it is right, else the course's own. ``exercises.turn.hint()`` prints the next of three hints,
``exercises.turn.solution()`` shows an answer, and `progress` says what is solved.

What an exercise is: `arkaq_edu.exercises.exercise`. Each chapter has a module with the right
answers and the random cases, and beside it a TOML file with the words: praise, hints, known wrong
answers.

Examples
--------
>>> from arkaq_edu import exercises
>>> turn = exercises.turn.check(lambda x, P, u, z, Q, R: (x + u, P + Q))
Not yet: the estimate is the prediction alone: the sighting changes nothing.
This page goes on with the course's own turn. Change yours, then run both cells again.
>>> expected_reward = exercises.expected_reward.check(lambda b, R: b @ R)
Right: a mean over what the state may be. It is the true expected reward.
>>> exercises.expected_reward.solution()  # doctest: +ELLIPSIS
def expected_reward(b, R):
    ...
    return b @ R
"""

from arkaq_edu._checks import choice
from arkaq_edu.exercises import solved
from arkaq_edu.exercises.approach import backup, boltzmann, reward, which_recipe
from arkaq_edu.exercises.arkaq import cell, decide, is_clear, sarsa_target
from arkaq_edu.exercises.art import choose, finer_categories, match, norm_r
from arkaq_edu.exercises.belief import (
    correct,
    expected_reward,
    observation_chances,
    predict,
    what_is_wrong,
)
from arkaq_edu.exercises.beyond import one_of_twenty, paired, torn, worst
from arkaq_edu.exercises.errata import coldest, even_depth, variance_of
from arkaq_edu.exercises.exercise import Exercise
from arkaq_edu.exercises.field import ball, pose, scoring_chance, what_a_test_says
from arkaq_edu.exercises.goal import kicks_needed, state_bounds, what_to_improve, worth
from arkaq_edu.exercises.kalman import combine, nis, turn, what_to_change
from arkaq_edu.exercises.learning import (
    discounted_sum,
    epsilon_greedy,
    finite_sum,
    regret,
    which_best,
)
from arkaq_edu.exercises.mdp import bellman, greedy, rate, smallest_state, td
from arkaq_edu.exercises.pomdp import best, lead, two_steps, worth_a_look
from arkaq_edu.exercises.segmentation import nearest, present, scale, too_fine

#: The exercises of each chapter, in their order.
CHAPTERS: dict[str, tuple[Exercise, ...]] = {
    "learning": (finite_sum, discounted_sum, epsilon_greedy, regret, which_best),
    "mdp": (bellman, greedy, td, rate, smallest_state),
    "belief": (predict, correct, observation_chances, expected_reward, what_is_wrong),
    "pomdp": (two_steps, best, lead, worth_a_look),
    "kalman": (combine, turn, nis, what_to_change),
    "art": (match, choose, norm_r, finer_categories),
    "segmentation": (scale, nearest, present, too_fine),
    "field": (pose, ball, scoring_chance, what_a_test_says),
    "arkaq": (decide, cell, sarsa_target, is_clear),
    "approach": (reward, boltzmann, backup, which_recipe),
    "goal": (state_bounds, worth, kicks_needed, what_to_improve),
    "beyond": (paired, worst, torn, one_of_twenty),
    "errata": (coldest, variance_of, even_depth),
}


def progress(chapter: str | None = None) -> None:
    """Print which exercises are solved, of one chapter or of all.

    In a student's copy of the course this is kept from one session to the next.

    Parameters
    ----------
    chapter : str, optional
        The name of a chapter, such as "kalman".

    Raises
    ------
    ValueError
        If there is no such chapter.

    Examples
    --------
    >>> progress("art")  # doctest: +ELLIPSIS
    art: ... of 4 exercises solved...
    """
    done = solved.names()
    for name in CHAPTERS if chapter is None else [choice("chapter", chapter, CHAPTERS)]:
        names = [exercise.name for exercise in CHAPTERS[name]]
        still = ", ".join(n for n in names if n not in done)
        count = sum(n in done for n in names)
        print(
            f"{name}: {count} of {len(names)} exercises solved"
            + (f"; still open: {still}" if still else ", that is all of them")
        )


__all__ = ["CHAPTERS", "Exercise", "progress", *(e.name for c in CHAPTERS.values() for e in c)]
