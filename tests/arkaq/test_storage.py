"""Files of agents, and runs that are interrupted."""

import itertools
import json
import math
import os
import tracemalloc
import zipfile

import numpy as np
import pytest

from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import (
    Arkaq,
    ExpectedSarsa,
    Sarsa,
    TrainingSettings,
    UniformGrid,
    storage,
)
from arkaq_edu.art import ART2A, EuclideanART
from arkaq_edu.mdp import QLearner
from tests.arkaq.brief import (
    BRIEF,
    BRIEF_GOAL,
    arrays,
    brief_agent,
    brief_scorer,
    digest,
    near_task,
)


def test_a_saved_agent_is_the_same_agent(brief, saved):
    loaded = Arkaq.load(saved)
    assert digest(loaded) == digest(brief)
    for name, values in arrays(brief).items():
        assert np.array_equal(arrays(loaded)[name], values), name
        assert arrays(loaded)[name].dtype == values.dtype, name
    assert (loaded.vigilance, loaded.seed) == (brief.vigilance, brief.seed)
    assert loaded.learning == brief.learning
    assert loaded.sensing.to_json() == brief.sensing.to_json()
    assert loaded.history == brief.history


def test_a_file_is_the_same_bytes_each_time_and_holds_no_code(brief, saved, tmp_path):
    again = tmp_path / "again.npz"
    Arkaq.load(saved).save(again)
    assert again.read_bytes() == saved.read_bytes()
    assert os.listdir(tmp_path) == ["again.npz"]
    with np.load(saved, allow_pickle=False) as file:
        assert json.loads(str(file["settings"]))["format"] == 1
        assert np.array_equal(file["Q"], brief.q.Q)


def test_a_scorer_is_saved_with_its_task(tmp_path):
    scorer, path = brief_scorer(), tmp_path / "scorer.npz"
    scorer.save(path)
    loaded = Arkaq.load(path)
    assert digest(loaded) == digest(scorer)
    assert (loaded.task, loaded.learning) == ("goal", BRIEF_GOAL)
    walker = Arkaq(0.06, sensing="goal", learning=BRIEF_GOAL, rng=4)
    with pytest.raises(ValueError, match="another task"):
        walker.learn(near_task(), path, progress=False)


def test_the_file_of_the_ball_is_what_it_was_before_there_was_a_goal(tmp_path):
    course = data_file("ball_approach.npz")
    Arkaq.load(course).save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == course.read_bytes()


def test_an_agent_that_has_not_learned_can_be_saved_too(tmp_path):
    path = tmp_path / "young.npz"
    Arkaq(0.2, learning=BRIEF, rng=4).save(path)
    assert digest(Arkaq.load(path).learn(near_task(), progress=False)) == digest(brief_agent())


@pytest.mark.parametrize("kind", [np.int64, np.int32])
def test_numpy_numbers_are_settings_too(tmp_path, kind):
    path = tmp_path / "agent.npz"
    training = TrainingSettings(
        patterns=kind(150), exploration=kind(200), exploitation=200, gamma=np.float32(0.5)
    )
    Arkaq(np.float64(0.2), learning=training, rng=kind(4)).save(path)
    assert Arkaq.load(path).learning == training


def test_a_save_that_fails_leaves_the_old_file(brief, tmp_path, monkeypatch):
    path = tmp_path / "agent.npz"
    brief.save(path)
    before = path.read_bytes()

    def broken(file, **arrays):
        file.write(b"half a fi")
        raise OSError("no space left on device")

    monkeypatch.setattr(np, "savez_compressed", broken)
    with pytest.raises(OSError, match="no space"):
        brief.save(path)
    assert path.read_bytes() == before


def refused(path):
    with pytest.raises(ValueError, match="not an agent") as caught:
        Arkaq.load(path)
    return str(path) in str(caught.value)


def test_a_truncated_file_is_refused(saved, tmp_path):
    data, path = saved.read_bytes(), tmp_path / "short.npz"
    for length in [0, 1, 10, *range(50, len(data), 97), len(data) - 1]:
        path.write_bytes(data[:length])
        assert refused(path)


def test_a_damaged_file_is_refused_or_unharmed(brief, saved, tmp_path):
    """A flipped byte is noticed, unless it lies where nothing is saved, as in a file's date."""
    data, path, rng = saved.read_bytes(), tmp_path / "damaged.npz", np.random.default_rng(0)
    caught = 0
    for place in [
        *range(0, 200, 3),
        *range(200, len(data) - 600, 23),
        *range(len(data) - 600, len(data), 5),
    ]:
        damaged = bytearray(data)
        damaged[place] ^= int(rng.integers(1, 256))
        path.write_bytes(damaged)
        try:
            assert digest(Arkaq.load(path)) == digest(brief)
        except ValueError as error:
            assert str(path) in str(error)
            caught += 1
    assert caught > 150


def altered(saved, path, settings=None, **changes):
    """Write the agent's file again with other contents; None takes an array out."""
    with np.load(saved) as file:
        contents = {name: file[name] for name in file.files}
    changed = json.loads(str(contents["settings"])) | (settings or {})
    contents["settings"] = np.array(json.dumps(changed))
    contents |= changes
    np.savez(path, **{name: values for name, values in contents.items() if values is not None})


def test_an_altered_file_is_refused(brief, saved, tmp_path):
    path = tmp_path / "altered.npz"
    altered(saved, path)
    assert digest(Arkaq.load(path)) == digest(brief)
    Q, visits, centers = brief.q.Q, brief.q.visits, brief.art.cluster_centers_
    contents = [
        {"Q": Q * math.nan},
        {"Q": Q[:-1]},
        {"Q": Q[0]},
        {"Q": None, "visits": None, "centers": None, "counts": None, "history": None},
        {"visits": visits[0]},
        {"visits": -1 - visits},
        {"visits": visits[:, :2]},
        {"visits": None},
        {"centers": None},
        {"centers": centers * math.inf},
        {"centers": np.hstack([centers, centers])},
        {"counts": brief.art.counts_[1:]},
        {"counts": -brief.art.counts_},
        {"history": None},
        {"history": np.full((3, 4), math.nan)},
        {"history": np.zeros((3, 5))},
        {"centers": np.array([{"a": 1}], dtype=object)},
    ]
    for changes in contents:
        altered(saved, path, **changes)
        assert refused(path), changes
    settings = [
        {"format": 2}, {"format": None}, {"phase": "asleep"}, {"done_in_phase": -1},
        {"done_in_phase": "x"}, {"cycles": None}, {"seed": 1.5}, {"seed": -1}, {"vigilance": 0},
        {"vigilance": "x"}, {"learning": {"gamma": 2}}, {"learning": {"patience": 2}},
        {"learning": []}, {"sensing": []}, {"sensing": {"low": [0], "high": [1]}},
    ]  # fmt: skip
    for changes in settings:
        altered(saved, path, settings=changes)
        assert refused(path), changes


def test_numbers_that_no_agent_has_are_refused(brief, saved, tmp_path):
    path = tmp_path / "altered.npz"
    counts, history = brief.art.counts_, np.zeros((2, 4))
    sensing = brief.sensing.to_json()
    contents = [
        {"counts": counts.astype(np.float64)},
        {"counts": counts.astype(np.uint64) + np.uint64(2**63)},
        {"visits": brief.q.visits.astype(np.uint64) + np.uint64(2**63)},
        {"Q": brief.q.Q + 1e308},
        {"Q": brief.q.Q.astype("S8")},
        {"history": np.add(history, [0, 1e300, 0, 0])},
        {"history": np.add(history, [0, 0.5, 0, 0])},
        {"history": np.add(history, [2, 1, 0, 0])},
        {"history": np.add(history, [0, 1, math.nan, 0])},
        {"history": np.add(history, [0, 1, 1e308, 0])},
    ]
    for changes in contents:
        altered(saved, path, **changes)
        assert refused(path), changes
    settings = [
        {"done_in_phase": 2**64}, {"cycles": 2**64}, {"cycles": 1e300}, {"seed": 2**64},
        {"vigilance": 1e308}, {"sensing": sensing | {"range_noise": 1e308}},
        {"sensing": sensing | {"high": [1e308, 0.5]}}, {"sensing": sensing | {"low": ["200", "0"]}},
        {"sensing": sensing | {"A": [[math.nan, 0.0], [0.0, 1.0]]}},
        {"sensing": sensing | {"P0": [[1e308, 0.0], [0.0, 1.0]]}},
        {"learning": {"patterns": 10**12}}, {"learning": {"hot": math.inf}},
        {"segmenter": {"class": "UniformGrid", "cells": [10**6, 10**6]}},
        {"environments": []}, {"environments": {"lunch": {}}}, {"environments": {"Q-learning": 1}},
    ]  # fmt: skip
    for changes in settings:
        altered(saved, path, settings=changes)
        assert refused(path), changes


def test_an_agent_without_what_its_phase_has_is_refused(saved, tmp_path):
    path = tmp_path / "altered.npz"
    for name in ("counts", "centers", "Q", "visits", "history", "settings"):
        altered(saved, path)
        with np.load(path) as file:
            np.savez(path, **{other: file[other] for other in file if other != name})
        assert refused(path), name


def huge(path, name, header, data=b"", compression=zipfile.ZIP_DEFLATED):
    """Write an archive with one array, whose header need not be true."""
    with zipfile.ZipFile(path, "w", compression) as archive, archive.open(name, "w") as file:
        np.lib.format.write_array_header_1_0(file, header)
        file.write(data)


def memory(call):
    """The most memory that a call took (bytes)."""
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_an_array_that_nobody_needs_is_not_unpacked(brief, saved, tmp_path):
    path = tmp_path / "large.npz"
    path.write_bytes(saved.read_bytes())
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("notes.npy", bytes(2**27))
    assert memory(lambda: Arkaq.load(path)) < 2**24
    assert digest(Arkaq.load(path)) == digest(brief)


@pytest.mark.parametrize(
    ("shape", "dtype", "data"),
    [
        ((2**40,), "<f8", b""),
        ((2**40, 2**40), "<f8", b""),
        ((2**62, 0), "<f8", b"x"),
        ((100,), "<f8", b"few"),
        ((-1,), "<f8", b""),
        ((), f"<U{2**28}", b""),
        ((3,), "|O", b"gASVBgAAAAAAAACMAm9zlC4="),
        ((2**26,), "<f8", bytes(2**20)),
    ],
)
def test_an_array_that_claims_to_be_huge_is_refused_before_memory_is_taken(
    shape, dtype, data, tmp_path
):
    path = tmp_path / "huge.npz"
    header = {"descr": dtype, "fortran_order": False, "shape": shape}
    for name in ("settings.npy", "Q.npy"):
        huge(path, name, header, data)
        assert memory(lambda: refused(path)) < 2**24
        assert len(message(path)) < 300


def test_an_array_that_is_huge_is_refused_before_memory_is_taken(tmp_path, monkeypatch):
    path = tmp_path / "huge.npz"
    monkeypatch.setattr(storage, "MOST_BYTES", 2**22)
    header = {"descr": "<f8", "fortran_order": False, "shape": (2**22,)}
    huge(path, "Q.npy", header, bytes(2**25))
    assert path.stat().st_size < 2**16
    assert memory(lambda: refused(path)) < 2**22
    assert "Q must take at most 4,194,304 bytes of memory, got 33,554,432" in message(path)


def test_other_ways_to_pack_an_array_are_refused(saved, tmp_path):
    path = tmp_path / "odd.npz"
    header = {"descr": "<f8", "fortran_order": False, "shape": (1,)}
    huge(path, "Q.npy", header, bytes(8), zipfile.ZIP_LZMA)
    assert "Q must be stored or deflated" in message(path)
    with zipfile.ZipFile(path, "w") as archive, archive.open("Q.npy", "w") as file:
        np.lib.format.write_array(file, np.zeros(1), version=(3, 0))
    assert "Q must be an npy array of version 1 or 2, got (3, 0)" in message(path)
    with zipfile.ZipFile(path, "w") as archive, archive.open("Q.npy", "w") as file:
        np.lib.format.write_array(file, np.zeros(1), version=(2, 0))
    assert "it has no 'settings'" in message(path)


def message(path):
    with pytest.raises(ValueError, match="not an agent") as caught:
        Arkaq.load(path)
    return str(caught.value)


def test_a_refusal_is_short_and_never_advises_to_run_what_is_in_the_file(brief, saved, tmp_path):
    text, path = tmp_path / "a.txt", tmp_path / "altered.npz"
    text.write_text("good morning\n" * 1000)
    messages = [message(text)]
    for changes in (
        {"counts": -brief.art.counts_},
        {"Q": np.full((500, 500), math.nan)},
        {"history": np.full((500, 4), -1.0)},
        {"centers": np.array([{"a": 1}] * 500, dtype=object)},
    ):
        altered(saved, path, **changes)
        messages.append(message(path))
    assert all(len(words) < len(str(path)) + 200 for words in messages)
    assert not any("unsafe" in words or "pickle" in words for words in messages)


def test_what_is_no_agent_at_all_is_refused(tmp_path):
    text, array, folder = tmp_path / "a.txt", tmp_path / "a.npy", tmp_path / "a"
    text.write_text("good morning")
    np.save(array, np.zeros(3))
    folder.mkdir()
    other = tmp_path / "other.npz"
    np.savez(other, settings=np.array("[1, 2]"))
    assert all(map(refused, (text, array, folder, other)))
    for settings in (np.array(7), np.array("[" * 100_000), np.array("{}"), np.array(["{}"] * 2)):
        np.savez(other, settings=settings)
        assert refused(other)
    with pytest.raises(FileNotFoundError):
        Arkaq.load(tmp_path / "nowhere.npz")


def test_the_message_about_a_damaged_archive_stays_short(brief, tmp_path):
    path = tmp_path / "agent.npz"
    brief.save(path)
    data = bytearray(path.read_bytes())
    at = data.index(b"visits.npy")  # a name in the file that is not the directory's, and very long
    data[at - 4 : at - 2] = (9000).to_bytes(2, "little")
    path.write_bytes(data)
    with pytest.raises(ValueError, match="is not an agent that can be read") as caught:
        Arkaq.load(path)
    assert len(str(caught.value)) < 1000


def interrupted(env, step=-1, reset=-1):
    """The environment, in which Ctrl-C comes at the k-th step, or at the k-th reset."""
    world = env.unwrapped

    def counted(go_on, k):
        left = itertools.count(k - 1, -1)

        def count(*args, **options):
            if next(left) == 0:
                raise KeyboardInterrupt
            return go_on(*args, **options)

        return count

    world.step, world.reset = counted(world.step, step), counted(world.reset, reset)
    return env


@pytest.fixture
def often(monkeypatch):
    monkeypatch.setattr(storage, "SECONDS_BETWEEN_CHECKPOINTS", -1.0)


@pytest.mark.parametrize(
    "when",
    [
        {"step": 1}, {"step": 20}, {"step": 77}, {"step": 150}, {"step": 190}, {"step": 260},
        {"step": 420}, {"step": 540}, {"reset": 1}, {"reset": 2}, {"reset": 15}, {"reset": 60},
    ],
)  # fmt: skip
@pytest.mark.parametrize("same", [True, False], ids=["same agent", "new agent"])
def test_an_interrupted_run_comes_to_the_same_result(brief, tmp_path, often, when, same):
    path = tmp_path / "run.npz"
    learner = Arkaq(0.2, learning=BRIEF, rng=4)
    with pytest.raises(KeyboardInterrupt):
        learner.learn(interrupted(near_task(), **when), path, progress=False)
    assert Arkaq.load(path).seed == 4
    if not same:
        learner = Arkaq(0.2, learning=BRIEF, rng=4)
    learner.learn(near_task(), path, progress=False)
    assert digest(learner) == digest(brief)
    assert digest(Arkaq.load(path)) == digest(brief)


def test_both_phases_are_interrupted_above(brief):
    segmentation = sum(row[1] for row in brief.history if row[0] == "segmentation")
    assert 77 < segmentation < 260 < 540 < brief.cycles


def test_a_run_interrupted_again_and_again_comes_to_the_same_result(brief, tmp_path, often):
    path, interruptions = tmp_path / "run.npz", 0
    while True:
        learner = Arkaq(0.2, learning=BRIEF, rng=4)
        try:
            learner.learn(interrupted(near_task(), step=45), path, progress=False)
            break
        except KeyboardInterrupt:
            interruptions += 1
    assert interruptions > 8
    assert digest(learner) == digest(brief)


def test_even_the_first_moments_leave_a_file(tmp_path):
    path = tmp_path / "run.npz"
    with pytest.raises(KeyboardInterrupt):
        brief_agent(env=interrupted(near_task(), step=30), checkpoint=path)
    assert Arkaq.load(path).learning == BRIEF


def test_a_finished_run_is_not_run_again(brief, tmp_path):
    path = tmp_path / "run.npz"
    assert digest(brief_agent(checkpoint=path)) == digest(brief)
    before = path.read_bytes()
    untouchable = interrupted(near_task(), step=1, reset=1)
    assert digest(brief_agent(env=untouchable, checkpoint=path)) == digest(brief)
    assert path.read_bytes() == before


def test_a_checkpoint_of_another_run_is_refused_and_left_alone(saved):
    before = saved.read_bytes()
    others = {
        "seed": Arkaq(0.2, learning=BRIEF, rng=5),
        "vigilance": Arkaq(0.25, learning=BRIEF, rng=4),
        "sensing": Arkaq(0.2, sensing="thesis", learning=BRIEF, rng=4),
        "learning": Arkaq(0.2, learning=TrainingSettings(patterns=151), rng=4),
    }
    for what, other in others.items():
        with pytest.raises(ValueError, match=f"another {what}") as caught:
            other.learn(near_task(), saved, progress=False)
        assert str(saved) in str(caught.value)
        assert other.q is None
    assert saved.read_bytes() == before


def test_a_damaged_checkpoint_is_refused_and_left_alone(tmp_path):
    path = tmp_path / "run.npz"
    path.write_bytes(b"PK\x03\x04 no more than that")
    with pytest.raises(ValueError, match="not an agent"):
        brief_agent(checkpoint=path)
    assert path.read_bytes() == b"PK\x03\x04 no more than that"


# Other parts ------------------------------------------------------------------------------------

PARTS = [
    {"segmenter": UniformGrid((6, 5))},
    {"segmenter": EuclideanART(0.3, 0.5, max_clusters=4)},
    {"learner": Sarsa()},
    {"learner": ExpectedSarsa()},
    {"segmenter": UniformGrid((4, 4)), "learner": Sarsa()},
]


@pytest.mark.parametrize("parts", PARTS, ids=str)
@pytest.mark.parametrize("stop", [77, 260, None])
def test_other_parts_of_the_house_are_saved_whole_and_resumed(parts, stop, tmp_path, often):
    path = tmp_path / "agent.npz"
    once = Arkaq(learning=BRIEF, rng=4, **parts).learn(near_task(), progress=False)
    if stop is not None:
        with pytest.raises(KeyboardInterrupt):
            env = interrupted(near_task(), step=stop)
            Arkaq(learning=BRIEF, rng=4, **parts).learn(env, path, progress=False)
        Arkaq(learning=BRIEF, rng=4, **parts).learn(near_task(), path, progress=False)
    else:
        once.save(path)
    loaded = Arkaq.load(path)
    assert digest(loaded) == digest(once)
    assert type(loaded.art) is type(once.art) and type(loaded.q) is type(once.q)
    assert loaded.art.get_params() == once.art.get_params()
    again = tmp_path / "again.npz"
    loaded.save(again)
    assert again.read_bytes() == path.read_bytes()


class MyGrid(UniformGrid):
    """A segmenter that the package does not know."""


class MyLearner(Sarsa):
    """A learner that the package does not know."""


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"segmenter": MyGrid((6, 5))}, "segmenter must be one of .*UniformGrid.*, got MyGrid"),
        ({"segmenter": ART2A(0.98, 0.1)}, "segmenter must be one of .*, got ART2A"),
        ({"learner": MyLearner()}, "learner must be one of .*Sarsa.*, got MyLearner"),
    ],
)
def test_parts_of_ones_own_are_refused_by_name_before_any_work(parts, words, tmp_path):
    path = tmp_path / "agent.npz"
    agent = Arkaq(learning=BRIEF, rng=4, **parts)
    with pytest.raises(ValueError, match=words):
        agent.learn(interrupted(near_task(), reset=1), path, progress=False)
    agent.learn(near_task(), progress=False)
    with pytest.raises(ValueError, match=words):
        agent.save(path)
    assert os.listdir(tmp_path) == []


def test_a_part_that_is_set_later_is_saved_as_what_it_is_or_refused(tmp_path):
    path = tmp_path / "agent.npz"
    agent = brief_agent()
    learned = agent.art
    agent.art = MyGrid((6, 5))
    with pytest.raises(ValueError, match="got MyGrid"):
        agent.save(path)
    parameters = {"vigilance": 0.7, "learning_rate": "count", "max_clusters": 50}
    agent.art = EuclideanART.from_centers(learned.cluster_centers_, learned.counts_, **parameters)
    agent.save(path)
    assert Arkaq.load(path).art.get_params() == parameters
    agent.art, agent.q = learned, QLearner(learned.n_clusters_, 3, 0.1, 0.9)
    with pytest.raises(ValueError, match="got QLearner"):
        agent.save(path)


def test_a_checkpoint_with_other_parts_is_refused(saved):
    before = saved.read_bytes()
    for parts in PARTS:
        name = next(iter(parts))
        with pytest.raises(ValueError, match=f"another {name}"):
            Arkaq(0.2, learning=BRIEF, rng=4, **parts).learn(near_task(), saved, progress=False)
    assert saved.read_bytes() == before


def test_an_unknown_part_in_a_file_is_refused(brief, saved, tmp_path):
    path = tmp_path / "altered.npz"
    for settings in (
        {"segmenter": {"class": "os.system"}},
        {"segmenter": {"class": "UniformGrid", "cells": [2, 2]}},
        {"segmenter": {"class": "UniformGrid", "cells": [0]}},
        {"segmenter": {"class": "EuclideanART", "size": 1}},
        {"segmenter": []},
        {"learner": {"class": "MyLearner"}},
        {"learner": {"class": "Sarsa", "speed": 2}},
    ):
        altered(saved, path, settings=settings)
        assert refused(path), settings
    altered(saved, path, settings={"learner": {"class": "Sarsa"}})
    assert digest(Arkaq.load(path)) == digest(brief)
