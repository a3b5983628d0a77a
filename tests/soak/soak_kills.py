"""The long commands killed at random moments, on a full disk and on a closed one."""

import subprocess
import time

import pytest

from tests.soak.command import SHARE, stopped
from tests.soak.kills import broken, contents, killed_until_done

PLAN = """seeds = 2
[grid]
vigilance = [0.2, 0.3]
[settings]
patterns = 500
exploration = 2000
exploitation = 1000
"""
COMMANDS = {
    "train": ["train", "--seed", 3],
    "train goal": ["train", "goal", "--seed", 3],
    "reproduce": ["reproduce", "--seeds", 1, "--approaches", 20, "--jobs", 2],
    "study": ["study", "../plan.toml", "--out", "study", "--jobs", 2],
}


@pytest.fixture(autouse=True)
def plan(tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_killed_at_random_moments_ends_in_the_same_bytes(tmp_path, name):
    whole, begin = tmp_path / "whole", time.monotonic()
    assert killed_until_done(COMMANDS[name], whole, kills=0, longest=0) == 0
    takes = time.monotonic() - begin
    kills = max(2, round(20 * SHARE))
    hits = killed_until_done(COMMANDS[name], tmp_path / "killed", kills=kills, longest=takes)
    assert hits > kills // 4
    assert contents(tmp_path / "killed") == contents(whole)


@pytest.fixture
def small_disk(tmp_path):
    """A folder on a disk of its own that is soon full, where the system lets one mount it."""
    folder = tmp_path / "small"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8k", "tmpfs", str(folder)])
    if mounted.returncode:
        pytest.skip("this user cannot mount a disk")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.parametrize("name", COMMANDS)
def test_on_a_full_disk_a_command_says_so_and_goes_on_when_there_is_room(
    tmp_path, small_disk, name
):
    ended = stopped(COMMANDS[name], small_disk, 0, None, patience=1800)
    assert ended.status == 2
    assert "No space left" in ended.said and "Traceback" not in ended.said
    assert broken(small_disk) == []
    subprocess.run(["mount", "-o", "remount,size=100m", str(small_disk)], check=True)
    assert killed_until_done(COMMANDS[name], small_disk, kills=0, longest=0) == 0
    killed_until_done(COMMANDS[name], tmp_path / "whole", kills=0, longest=0)
    assert contents(small_disk) == contents(tmp_path / "whole")


@pytest.mark.parametrize("name", COMMANDS)
def test_on_a_disk_that_cannot_be_written_a_command_says_so(small_disk, name):
    (small_disk / "mine.txt").write_text("mine")
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    ended = stopped(COMMANDS[name], small_disk, 0, None, patience=600)
    assert ended.status == 2
    assert "Read-only" in ended.said and "Traceback" not in ended.said
    assert list(small_disk.iterdir()) == [small_disk / "mine.txt"]
