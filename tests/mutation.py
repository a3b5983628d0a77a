"""Mutation testing: break the methods on purpose, and see which breaks no test notices.

``python -m tests.mutation ROOM... --sample 150 --seed 0`` draws places in the code of a room, makes
one of Cosmic Ray's changes at each, and runs the tests that reach the changed line, in a process
of its own. Kernels run as plain Python, so that a change in one is always seen.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import difflib
import importlib
import importlib.machinery
import io
import math
import multiprocessing
import os
import random
import signal
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

# To look for pytest's plugins takes longer than a test.
PLAINLY = ("NUMBA_DISABLE_JIT", "PYTEST_DISABLE_PLUGIN_AUTOLOAD", "OPENBLAS_NUM_THREADS")

ROOT = Path(__file__).parents[1]
ENDLESS = 30.0  # seconds of work after which a mutant counts as noticed: it may never end
# Pytest must not load the modules by a loader of its own, as it does to rewrite their asserts.
PYTEST = ["-q", "-p", "no:cacheprovider", "--assert=plain"]
PYTEST += ["-o", "addopts=--doctest-modules"]


# What the tests load besides the package is loaded once, before the processes part.
PRELOADED = ["_pytest.doctest", "filterpy.kalman", "gymnasium", "hypothesis.extra.numpy", "numba"]
PRELOADED += ["pandas", "scipy.optimize", "scipy.sparse", "scipy.stats"]
PRELOADED += ["sklearn.utils.estimator_checks"]


class Mutant(NamedTuple):
    """One change, as Cosmic Ray names it."""

    path: str
    line: int
    operator: str
    occurrence: int

    def sources(self) -> tuple[str, str]:
        """Return the module as it is and as it would be."""
        from cosmic_ray.mutating import mutate_code
        from cosmic_ray.plugins import get_operator

        source = Path(self.path).read_text("utf-8")
        return source, mutate_code(source, get_operator(self.operator)(), self.occurrence)

    def diff(self) -> str:
        """Return the change as a diff without its heading."""
        lines = difflib.unified_diff(*(s.splitlines() for s in self.sources()), n=0, lineterm="")
        name = self.operator.split("/")[1]
        return "\n".join([f"{self.path}:{self.line} {name}", *list(lines)[3:]])


class Timeout(BaseException):
    """Raised where a test runs for too long; no test catches it."""


def places(path: Path) -> list[list[Mutant]]:
    """Return the places of a module that can be changed, each with its changes.

    Type hints and the text of messages are left out: they don't change what the code does. So is
    the decorator of a kernel, which only makes it fast.
    """
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator, operator_names

    source = path.read_text("utf-8")
    left_out = [span(node) for node in ast.walk(ast.parse(source)) for node in words(node)]
    nodes = list(ast_nodes(get_ast(source)))
    found: dict[object, list[Mutant]] = defaultdict(list)
    for name in operator_names():
        if get_operator(name).arguments():
            continue  # needs to be told which variable
        operator = get_operator(name)()
        spots = (spot for node in nodes for spot in operator.mutation_positions(node))
        for occurrence, (start, end) in enumerate(spots):
            if not any(first <= start and end <= last for first, last in left_out):
                mutant = Mutant(str(path.relative_to(ROOT)), start[0], name, occurrence)
                found[start].append(mutant)
    return list(found.values())


def words(node: ast.AST) -> list[ast.AST]:
    """Return what is only for a reader below a node of the syntax tree."""
    hints = [getattr(node, "annotation", None), getattr(node, "returns", None)]
    if isinstance(node, ast.JoinedStr):
        hints.append(node)
    for decorator in getattr(node, "decorator_list", []):
        if ast.unparse(decorator) in {"kernel", "overload"}:
            hints.append(decorator)
    return [hint for hint in hints if hint is not None]


def span(node):
    return (node.lineno, node.col_offset - 1), (node.end_lineno, node.end_col_offset)


class Reach:
    """A pytest plugin that notes which lines each test runs, and for how long."""

    def __init__(self, room: str):
        import coverage

        self.coverage = coverage.Coverage(data_file=None, branch=True, source=[f"arkaq_edu/{room}"])
        self.seconds: dict[str, float] = {}

    def pytest_runtest_logstart(self, nodeid):
        self.coverage.switch_context(nodeid)

    def pytest_runtest_logreport(self, report):
        if report.when == "call" and report.passed:
            self.seconds[report.nodeid] = report.duration

    def tests(self) -> dict[tuple[str, int], list[str]]:
        """Return the tests that reach each line of the room, the fastest first."""
        data = self.coverage.get_data()
        reach: dict[tuple[str, int], list[str]] = {}
        for path in data.measured_files():
            contexts = data.contexts_by_lineno(path)
            for line, together in statements(Path(path).read_text("utf-8")).items():
                tests = {test for near in together for test in contexts.get(near, [])}
                tests &= self.seconds.keys()
                reach[os.path.relpath(path, ROOT), line] = sorted(tests, key=self.seconds.get)
        return reach


def statements(source: str) -> dict[int, range]:
    """Return for each line the lines that say whether a test reaches it.

    These are the lines of its statement; of the whole function for what is evaluated at its
    definition; and of the whole module for what stands outside functions.
    """
    whole = range(1, source.count("\n") + 2)
    found = dict.fromkeys(whole, whole)

    def visit(node, inside):
        for child in ast.iter_child_nodes(node):
            deeper = inside or isinstance(child, ast.FunctionDef)
            if deeper and isinstance(child, ast.stmt):
                lines = range(child.lineno, child.end_lineno + 1)
                head = getattr(child, "body", None)
                if head and not isinstance(child, ast.FunctionDef):
                    lines = range(child.lineno, max(head[0].lineno, child.lineno + 1))
                found.update(dict.fromkeys(range(child.lineno, child.end_lineno + 1), lines))
            visit(child, deeper)

    visit(ast.parse(source), False)
    return found


class Only:
    """A pytest plugin that runs these tests, in this order, and no others."""

    def __init__(self, tests: list[str]):
        self.order = {test: i for i, test in enumerate(tests)}

    def pytest_collection_modifyitems(self, items):
        items[:] = sorted(
            (item for item in items if item.nodeid in self.order),
            key=lambda item: self.order[item.nodeid],
        )


def measure(room: str) -> dict[tuple[str, int], list[str]]:
    """Run the tests of a room once, unchanged."""
    import pytest

    reach = Reach(room)
    reach.coverage.start()
    with contextlib.redirect_stdout(io.StringIO()):
        pytest.main([*PYTEST, "-p", "tests.plain", f"arkaq_edu/{room}", f"tests/{room}"], [reach])
    reach.coverage.stop()
    return reach.tests()


def outcome_of(task: tuple[Mutant, list[str]]) -> tuple[Mutant, str]:
    """Run the tests that reach a mutant; return it with "noticed", "survived" or "not code"."""
    import pytest

    mutant, tests = task
    if not tests:
        return mutant, "survived"
    path, (_, changed) = str(ROOT / mutant.path), mutant.sources()
    try:
        compile(changed, path, "exec")
    except SyntaxError:
        return mutant, "not code"
    get_code = importlib.machinery.SourceFileLoader.get_code

    def broken(self, name):
        if self.path == path:
            return compile(changed, path, "exec", dont_inherit=True)
        return get_code(self, name)

    importlib.machinery.SourceFileLoader.get_code = broken
    signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, ENDLESS, 1)
    files = dict.fromkeys(test.split("::")[0] for test in tests)
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            status = pytest.main([*PYTEST, "-x", *files], [Only(tests)])
    except BaseException:
        status = pytest.ExitCode.TESTS_FAILED
    signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    if status in (pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED):
        return mutant, "noticed"
    assert status == pytest.ExitCode.OK, status
    return mutant, "survived"


def late(*_):
    raise Timeout


def interval(part: int, whole: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a share."""
    share, z = part / whole, 1.96
    middle = share + z * z / (2 * whole)
    half = z * math.sqrt(share * (1 - share) / whole + z * z / (4 * whole * whole))
    return (middle - half) / (1 + z * z / whole), (middle + half) / (1 + z * z / whole)


def main(arguments: list[str] | None = None) -> None:
    """Draw, change, test, and print what survived."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rooms", nargs="*", default=["kalman", "art", "mdp", "pomdp"])
    parser.add_argument("--sample", type=int, default=150, help="places to change in each room")
    parser.add_argument("--seed", type=int, default=0, help="which places")
    parser.add_argument("--jobs", type=int, default=2, help="processes at once")
    options = parser.parse_args(arguments)

    os.chdir(ROOT)
    os.environ |= dict.fromkeys(PLAINLY, "1")
    import hypothesis

    for name in PRELOADED:
        importlib.import_module(name)
    # The same examples for every mutant; what fails need not be made small nor remembered.
    phases = [hypothesis.Phase.explicit, hypothesis.Phase.generate]
    hypothesis.settings.register_profile(
        "mutation", phases=phases, derandomize=True, database=None, deadline=None
    )
    hypothesis.settings.load_profile("mutation")

    fork = multiprocessing.get_context("fork")
    for room in options.rooms:
        with fork.Pool(1) as pool:
            reach = pool.apply(measure, (room,))
        files = sorted((ROOT / "arkaq_edu" / room).glob("*.py"))
        all_places = [place for path in files for place in places(path)]
        rng = random.Random(options.seed)
        drawn = rng.sample(all_places, min(options.sample, len(all_places)))
        mutants = [rng.choice(place) for place in drawn]
        tasks = [(m, reach.get((m.path, m.line), [])) for m in mutants]
        outcomes = defaultdict(int)
        with fork.Pool(options.jobs, maxtasksperchild=1) as pool:
            for mutant, outcome in pool.imap_unordered(outcome_of, tasks):
                outcomes[outcome] += 1
                if outcome == "survived":
                    print(mutant.diff(), end="\n\n", flush=True)
        whole = outcomes["noticed"] + outcomes["survived"]
        low, high = interval(outcomes["noticed"], whole)
        print(
            f"{room}: {len(all_places)} places, {whole} changed, {outcomes['noticed']} noticed: "
            f"{outcomes['noticed'] / whole:.1%} (95 % interval {low:.0%} to {high:.0%})",
            flush=True,
        )


if __name__ == "__main__":
    main()
