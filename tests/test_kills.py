"""`arkaq train` in a process of its own, killed at random moments."""

import pytest

from tests.soak.kills import contents, killed_until_done

#: The command with short trainings, and a checkpoint after each episode.
PROGRAM = """
import os, sys
from arkaq_command import main
os.write(1, b"x")
from arkaq_edu.arkaq import TrainingSettings, storage
from arkaq_edu.experiments import approach
storage.SECONDS_BETWEEN_CHECKPOINTS = 0.02
learning = TrainingSettings(patterns=200, exploration=400, exploitation=200)
train, evaluate = approach.train, approach.evaluate
approach.train = lambda *args, **kwargs: train(*args, learning=learning, **kwargs)
approach.evaluate = lambda policy, n, seed: evaluate(policy, 5, seed)
main()
"""


@pytest.mark.slow
def test_train_killed_at_random_moments_ends_in_the_same_bytes(tmp_path):
    words = ["train", "--seed", 3]
    killed_until_done(words, tmp_path / "whole", kills=0, longest=0, program=PROGRAM)
    hits = killed_until_done(words, tmp_path / "killed", kills=2, longest=3, program=PROGRAM)
    assert hits > 0
    assert contents(tmp_path / "killed") == contents(tmp_path / "whole") != {}
