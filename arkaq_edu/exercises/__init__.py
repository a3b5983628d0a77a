"""Checks of the students' answers: they say in what way an answer is wrong, and never give it.

Each check takes the student's function, tries it on fresh random inputs, and returns a line to be
pleased about; where the answer is not right it raises `ExerciseError` with a line that helps.
"""

from arkaq_edu.exercises._ask import ExerciseError
from arkaq_edu.exercises.approach import check_backup, check_boltzmann, check_reward
from arkaq_edu.exercises.art import check_choose, check_match, check_norm_r
from arkaq_edu.exercises.belief import (
    check_chances,
    check_correct,
    check_expected_reward,
    check_predict,
)
from arkaq_edu.exercises.field import check_ball, check_chance, check_pose
from arkaq_edu.exercises.goal import check_kicks_needed, check_state_bounds, check_worth
from arkaq_edu.exercises.kalman import check_combine, check_nis, check_turn
from arkaq_edu.exercises.learning import (
    check_discounted_sum,
    check_epsilon_greedy,
    check_finite_sum,
    check_regret,
)
from arkaq_edu.exercises.mdp import check_bellman, check_greedy, check_rate, check_td
from arkaq_edu.exercises.pomdp import check_best, check_lead, check_two_steps
from arkaq_edu.exercises.segmentation import check_nearest, check_present, check_scale

__all__ = [
    "ExerciseError",
    "check_backup",
    "check_ball",
    "check_bellman",
    "check_best",
    "check_boltzmann",
    "check_chance",
    "check_chances",
    "check_choose",
    "check_combine",
    "check_correct",
    "check_discounted_sum",
    "check_epsilon_greedy",
    "check_expected_reward",
    "check_finite_sum",
    "check_greedy",
    "check_kicks_needed",
    "check_lead",
    "check_match",
    "check_nearest",
    "check_nis",
    "check_norm_r",
    "check_pose",
    "check_predict",
    "check_present",
    "check_rate",
    "check_regret",
    "check_reward",
    "check_scale",
    "check_state_bounds",
    "check_td",
    "check_turn",
    "check_two_steps",
    "check_worth",
]
