"""A briefly trained agent, and its file."""

import pytest

from tests.arkaq.brief import brief_agent


@pytest.fixture(scope="session")
def brief():
    return brief_agent()


@pytest.fixture(scope="session")
def saved(brief, tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "agent.npz"
    brief.save(path)
    return path
