"""What must hold of the whole house: how it is installed, what it imports, what it says."""

import ast
import inspect
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import tomllib
import urllib.request
import zipfile
from collections import defaultdict
from pathlib import Path

import click
import nbformat
import pytest
from click.testing import CliRunner
from packaging.requirements import Requirement

import arkaq_edu as ae
from arkaq_edu import _paths, cli, exercises, widgets
from arkaq_edu._copy import course_pages
from arkaq_edu._student import students_page

ROOT = Path(__file__).parents[1]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LOCK = (ROOT / "requirements.lock").read_text()


# Floors

FLOORS = [
    "kalman art mdp pomdp",
    "field",
    "arkaq",
    "envs",
    "experiments",
    "figures",
    "widgets exercises trace",
    "site release slides",
    "cli",
]
FLOOR = {room: number for number, rooms in enumerate(FLOORS) for room in rooms.split()}
TOO_HIGH_FOR_THE_GROUND = {"pymunk", "matplotlib", "ipywidgets", "anywidget"}


def imports(source, package):
    """Every module or name that the source text imports, in full, wherever in it that is."""
    found, aliases = set(), set()
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
            aliases |= {a.asname or a.name for a in node.names if a.name == "arkaq_edu"}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            found |= {module} | {f"{module}.{alias.name}" for alias in node.names}
    return found | {
        f"arkaq_edu.{node.attr}"
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id in aliases
    }


def climbs(source, path):
    """Those imports of the file at `path` (below the package) that do not point down."""
    room = path.parts[0].removesuffix(".py")
    found = imports(source, ["arkaq_edu", *path.parts[:-1]])
    own = FLOOR.get(room, -1)  # what belongs to no room stands below them all
    up = {
        name
        for name in found
        if name.startswith("arkaq_edu.") and FLOOR.get(name.split(".")[1], -1) > own
    }
    if own <= 0:
        up |= {name for name in found if name.split(".")[0] in TOO_HIGH_FOR_THE_GROUND}
    return up


def trespasses(source, path):
    """Those imports of the file at `path` that are private names of another room."""
    room = path.parts[0].removesuffix(".py")
    found = imports(source, ["arkaq_edu", *path.parts[:-1]])
    names = [name.split(".")[1:] for name in found if name.startswith("arkaq_edu.")]
    return {
        ".".join(parts)
        for parts in names
        if parts[0] != room and any(part.startswith("_") for part in parts[1:])
    }


@pytest.mark.parametrize(
    ("path", "source"),
    [
        ("widgets/art.py", "from arkaq_edu.art._index import nearest"),
        ("widgets/art.py", "from arkaq_edu.figures.art import _fill"),
        ("envs/goal.py", "from arkaq_edu._checks import _real"),
    ],
)
def test_a_private_name_of_another_room_is_noticed(path, source):
    assert trespasses(source, Path(path))


def test_no_private_name_leaves_its_room():
    package = ROOT / "arkaq_edu"
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in sorted(package.rglob("*.py"))
        for name in sorted(trespasses(path.read_text(), path.relative_to(package)))
    ]
    assert wrong == []


def test_every_import_within_the_package_is_absolute():
    relative = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in sorted((ROOT / "arkaq_edu").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and node.level
    ]
    assert relative == []


@pytest.mark.parametrize(
    ("path", "source"),
    [
        ("kalman.py", "from arkaq_edu.field import World"),
        ("kalman/filter.py", "from ..figures import style"),
        ("art/euclidean.py", "def f():\n    import matplotlib.pyplot as plt"),
        ("envs/goal.py", "import arkaq_edu as ae\nae.figures.figure_5_16()"),
        ("_checks.py", "from arkaq_edu import kalman"),
    ],
)
def test_an_import_that_points_up_is_noticed(path, source):
    assert climbs(source, Path(path))


def test_imports_only_point_down():
    package = ROOT / "arkaq_edu"
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in sorted(package.rglob("*.py"))
        if path.name != "__init__.py" or path.parent != package
        for name in sorted(climbs(path.read_text(), path.relative_to(package)))
    ]
    assert wrong == []


def test_importing_the_package_loads_no_heavy_library():
    heavy = ["numba", "sklearn", "scipy", "matplotlib", "pymunk", "pandas"]
    program = f"import sys, arkaq_edu; print([m for m in {heavy!r} if m in sys.modules])"
    answer = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True
    )
    assert answer.stdout.strip() == "[]"


# What is said


@pytest.mark.parametrize("name", ae.__all__)
def test_a_public_name_is_documented_with_an_example(name):
    thing = getattr(ae, name)
    text = inspect.getdoc(thing) or ""
    assert text, f"{name} does not say what it is"
    assert inspect.ismodule(thing) or re.search(r"^Examples\n-+\n(.*\n)*?>>> ", text, re.M), (
        f"{name} shows no example"
    )


def committed():
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("this is no clone, or there is no git")
    answer = subprocess.run([git, "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True)
    return [ROOT / name for name in answer.stdout.decode().split("\0") if name]


def test_nothing_committed_names_a_registry_or_one_machine():
    # Spelled in pieces, so that this file passes its own test.
    hosts = "(" + "|".join(["py" + "pi", "python" + "hosted", "npm" + "js", "ana" + "conda"]) + ")"
    folders = "(" + "|".join(["work", "tmp", "root", "Users/[a-z]+", "home/[a-z]+"]) + ")"
    told = re.compile(rf"{hosts}\.(org|com|io)|(?<![\w.])/{folders}/")
    found = []
    for path in committed():
        data = path.read_bytes() if path.is_file() else b""
        if b"\0" in data:
            continue
        for number, line in enumerate(data.decode(errors="replace").splitlines(), 1):
            # A stored picture is text that can spell anything.
            if '"image/png": "' not in line and ";base64," not in line and told.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}")
    assert found == []


def test_every_link_in_the_guides_leads_somewhere():
    broken = []
    for page in [*ROOT.glob("*.md"), *(ROOT / "notebooks").glob("*.ipynb")]:
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
            if ":" not in target and not (page.parent / target.split("#")[0]).exists():
                broken.append(f"{page.name}: {target}")
    assert broken == []


def test_every_promise_is_held_by_a_test_that_exists():
    rows = re.findall(r"^\| ([A-Z].*) \| (`.*`) \|$", (ROOT / "SECURITY.md").read_text(), re.M)
    assert len(rows) >= 12
    for promise, tests in rows:
        for path, name in re.findall(r"`(\S+)::(\w+)`", tests):
            assert f"def {name}(" in (ROOT / path).read_text(), promise


# Installing


def test_the_lock_holds_hashes_and_no_addresses():
    packages = re.findall(
        r"^(\S+==\S+)[^\n]*\\\n((?: +--hash=sha256:[0-9a-f]{64}.*\n)+)", LOCK, re.M
    )
    assert len(packages) == len(re.findall(r"^[a-z0-9]", LOCK, re.M)) > 100
    assert "://" not in LOCK


def test_the_lock_gives_what_the_project_asks_for():
    project = PYPROJECT["project"]
    wanted = [
        *project["dependencies"],
        *project["optional-dependencies"]["test"],
        *PYPROJECT["build-system"]["requires"],
    ]
    locked = defaultdict(list)  # a package may have one version for older Pythons, one for newer
    for name, version in re.findall(r"^([a-z0-9_.-]+)==(\S+)", LOCK, re.M):
        locked[name].append(version)
    missing = [
        r
        for r in map(Requirement, wanted)
        if not locked[r.name] or not all(version in r.specifier for version in locked[r.name])
    ]
    assert missing == []


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel, unpacked where no repository is near."""
    folder = tmp_path_factory.mktemp("wheel")
    build = "import hatchling.build, sys; print(hatchling.build.build_wheel(sys.argv[1]))"
    answer = subprocess.run(
        [sys.executable, "-c", build, str(folder)],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    unpacked = folder / "site"
    zipfile.ZipFile(folder / answer.stdout.split()[-1]).extractall(unpacked)
    return unpacked


def arkaq_from(wheel, *arguments, cwd):
    environment = {**os.environ, "PYTHONPATH": str(wheel)}
    return subprocess.run(
        [sys.executable, "-m", "arkaq_edu.cli", *arguments],
        cwd=cwd, env=environment, capture_output=True, text=True, timeout=60,
    )  # fmt: skip


def test_the_wheel_carries_the_students_course_and_no_solution(wheel, tmp_path):
    answer = arkaq_from(wheel, "lab", "--copy-only", cwd=tmp_path)
    assert answer.returncode == 0, answer.stderr
    copy = tmp_path / "arkaq-course"
    pages = course_pages()
    files = {p.relative_to(copy).as_posix(): p.read_bytes() for p in copy.rglob("*.*")}
    assert json.loads(files.pop(_paths.HANDED_OUT))["files"].keys() == pages.keys()
    assert files == pages, "those that a clone gives"
    notebooks = list(wheel.rglob("*.ipynb"))
    assert len(notebooks) == len(list((ROOT / "notebooks").glob("*.ipynb")))
    assert [p.name for p in notebooks if "SOLUTION" in p.read_text("utf-8")] == []
    assert not list(copy.rglob("*.py"))
    words = Path("arkaq_edu", "exercises", "kalman.toml")
    assert (wheel / words).read_bytes() == (ROOT / words).read_bytes()
    assert list(wheel.glob("*.data/data/share/jupyter/lab/settings/overrides.d/arkaq_edu.json"))


# The command


def run(*arguments):
    return CliRunner().invoke(cli.main, [str(a) for a in arguments])


def test_a_students_work_is_never_written_over(tmp_path):
    first = tmp_path / "notebooks" / _paths.FIRST_PAGE
    n = len(course_pages())
    begin = f"{tmp_path}: "
    assert run("lab", tmp_path, "--copy-only").output == (
        f"{begin}{n} files copied; what you write in them is never written over\n"
    )
    whole = first.read_bytes()
    extra = tmp_path / "notebooks" / "mine.ipynb"
    extra.write_text("mine")
    assert run("lab", tmp_path, "--copy-only").output == (
        f"{begin}nothing new: {n} files are there\n"
    )
    first.write_text("my answer")
    for _ in range(2):
        assert run("lab", tmp_path, "--copy-only").output == (
            f"{begin}nothing new: {n} files are there, 1 file changed by you and kept\n"
        )
    assert first.read_text() == "my answer" and extra.read_text() == "mine"

    first.rename(first.with_name("old.ipynb"))
    assert run("lab", tmp_path, "--copy-only").output == f"{begin}1 file copied\n"
    assert first.read_bytes() == whole


def test_an_upgrade_renews_what_is_untouched_and_puts_the_rest_beside_it(tmp_path, monkeypatch):
    pages = {f"notebooks/{name}.ipynb": b"old" for name in ("touched", "untouched", "same")}
    monkeypatch.setattr("arkaq_edu._copy.course_pages", lambda: pages)
    run("lab", tmp_path, "--copy-only")
    folder = tmp_path / "notebooks"
    (folder / "touched.ipynb").write_text("mine")
    (folder / "touched_new.ipynb").write_text("mine too")
    pages |= {f"notebooks/{name}.ipynb": b"new" for name in ("touched", "untouched")}
    assert run("lab", tmp_path, "--copy-only").output == (
        f"{tmp_path}: 1 file brought up to date, 1 file changed by you and kept\n"
        "  notebooks/touched.ipynb has a new version. Yours stays as it is; "
        "the new one is notebooks/touched_new1.ipynb\n"
    )
    assert {p.stem: p.read_text() for p in folder.iterdir()} == {
        "touched": "mine", "touched_new": "mine too", "touched_new1": "new", "untouched": "new",
        "same": "old",
    }  # fmt: skip
    assert run("lab", tmp_path, "--copy-only").output == (
        f"{tmp_path}: nothing new: 3 files are there, 1 file changed by you and kept\n"
    ), "it is said once, and no third page comes"


def test_a_copy_that_remembers_nothing_loses_nothing(tmp_path):
    run("lab", tmp_path, "--copy-only")
    page = tmp_path / "notebooks" / _paths.FIRST_PAGE
    page.write_text("my answer")
    memory = tmp_path / _paths.HANDED_OUT
    memory.write_text("scribble")
    answer = run("lab", tmp_path, "--copy-only")
    assert answer.exit_code == 2 and "cannot be read; delete it" in answer.output
    memory.unlink()
    assert "has a new version" in run("lab", tmp_path, "--copy-only").output
    assert page.read_text() == "my answer"


def test_a_students_page_has_no_solution_and_no_output_but_pictures_of_widgets(tmp_path):
    solutions, pictures = 0, 0
    makers = [name for name in widgets.__all__ if name.islower()]
    for master in sorted((ROOT / "notebooks").glob("*.ipynb")):
        cells = nbformat.read(master, as_version=4).cells
        page = nbformat.reads(students_page(master.read_text("utf-8")), as_version=4)
        nbformat.validate(page)
        for mine, theirs in zip(cells, page.cells, strict=True):
            if mine.metadata.get("nbgrader", {}).get("solution"):
                solutions += 1
                head, rest = mine.source.split("### BEGIN SOLUTION")
                solution, tail = rest.split("### END SOLUTION")
                assert theirs.source.startswith(head) and theirs.source.endswith(tail)
                assert "NotImplementedError" in theirs.source
                assert solution.strip() not in theirs.source
                ast.parse(theirs.source)
            else:
                assert mine.source == theirs.source
            for output in theirs.get("outputs", []):
                pictures += 1
                name = theirs.source.strip().splitlines()[-1].partition("(")[0].split(".")[-1]
                assert name in makers and output.data["image/png"]
    assert solutions == sum(map(len, exercises.CHAPTERS.values()))
    assert pictures >= len(makers)


def test_an_interrupted_copy_leaves_no_half_of_a_file(tmp_path, monkeypatch):
    def stop_halfway(path, content):
        path.write_text("half")
        raise OSError("No space left on device")

    monkeypatch.setattr(Path, "write_bytes", stop_halfway)
    answer = run("lab", tmp_path, "--copy-only")
    assert (answer.exit_code, answer.output) == (2, "arkaq: error: No space left on device\n")
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["dance"],
        ["--dance"],
        ["lab", "--dance"],
        ["lab", "one", "two"],
        ["lab", str(ROOT / "LICENSE")],
        ["lab", str(ROOT / "LICENSE" / "below"), "--copy-only"],
    ],
)
def test_bad_input_is_answered_with_one_line_and_status_2(arguments):
    answer = run(*arguments)
    assert answer.exit_code == 2
    assert re.fullmatch(r"arkaq: error: .+\n", answer.output)


def test_a_refusal_by_the_package_is_one_line_too_and_a_defect_is_not():
    @click.group(cls=cli.OneLineErrors)
    def group():
        pass

    @group.command()
    def refuse():
        raise ValueError("vigilance must be\n  a number in (0, 1], got -2")

    @group.command()
    def fail():
        raise KeyError("a defect")

    answer = CliRunner().invoke(group, ["refuse"])
    line = "arkaq: error: vigilance must be a number in (0, 1], got -2\n"
    assert (answer.exit_code, answer.output) == (2, line)
    assert isinstance(CliRunner().invoke(group, ["fail"]).exception, KeyError)


def test_every_command_explains_itself():
    assert run("--version").output == f"arkaq, version {PYPROJECT['project']['version']}\n"
    assert run().output == run("--help").output
    for name, command in cli.main.commands.items():
        answer = run(name, "--help")
        assert answer.exit_code == 0 and answer.output.startswith(f"Usage: arkaq {name}")
        first = command.help.split(".")[0]
        assert first in " ".join(run("--help").output.split())


def test_lab_opens_the_first_page(tmp_path):
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        port = s.getsockname()[1]
    environment = {**os.environ, "JUPYTER_PORT": str(port), "JUPYTER_TOKEN": "sesame"}
    server = subprocess.Popen(
        [sys.executable, "-m", "arkaq_edu.cli", "lab", str(tmp_path), "--no-browser"],
        env=environment, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        page = _answer(f"http://127.0.0.1:{port}/?token=sesame", server)
        with pytest.raises(OSError):  # what listens everywhere would answer here too
            socket.create_connection(("127.0.0.2", port), timeout=5)
    finally:
        server.terminate()
        server.wait(30)
    assert page.url.split("?")[0].endswith(f"/lab/tree/{_paths.FIRST_PAGE}")
    assert (tmp_path / "notebooks" / _paths.FIRST_PAGE).exists()


def _answer(address, server):
    for _ in range(1200):
        assert server.poll() is None, "JupyterLab stopped"
        try:
            return urllib.request.urlopen(address)
        except OSError:
            time.sleep(0.1)
    raise AssertionError("JupyterLab does not answer")


# The Makefile, with a Python that only pretends

PRETENDER = """#!/bin/sh
echo "$@" >> "$LOG"
case "$*" in
*ensurepip*) exit $TOO_OLD ;;
*venv*) mkdir -p .venv/bin; cp "$0" .venv/bin/python ;;
esac
"""


@pytest.fixture
def clone(tmp_path):
    """A folder, with a space in its name, that holds what `make install` reads."""
    make = shutil.which("make")
    if make is None:
        pytest.skip("there is no make")
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in ("cat", "cp", "echo", "mkdir"):
        (tools / tool).symlink_to(shutil.which(tool))
    python = tools / "python3"
    python.write_text(PRETENDER)
    python.chmod(0o755)
    folder = tmp_path / "my clone"
    folder.mkdir()
    for name in ("Makefile", "pyproject.toml", "requirements.lock"):
        shutil.copy(ROOT / name, folder)
    log = tmp_path / "log"

    def install(folder=folder, too_old=0):
        log.write_text("")
        environment = {"PATH": str(tools), "LOG": str(log), "TOO_OLD": str(too_old)}
        answer = subprocess.run(
            [make, "install"], cwd=folder, env=environment, capture_output=True, text=True
        )
        return answer, [line for line in log.read_text().splitlines() if " pip install " in line]

    return folder, install


def test_make_installs_by_hash_once(clone):
    folder, install = clone
    answer, pip = install()
    assert answer.returncode == 0, answer.stderr
    assert "--require-hashes --requirement requirements.lock" in pip[0]
    assert "--no-build-isolation --editable ." in pip[1]
    answer, pip = install()
    assert (answer.returncode, pip) == (0, [])

    soon = time.time() + 10
    os.utime(folder / "requirements.lock", (soon, soon))
    assert len(install()[1]) == 2


def test_make_installs_anew_where_the_folder_has_moved(clone):
    folder, install = clone
    install()
    moved = folder.rename(folder.with_name("elsewhere"))
    assert len(install(moved)[1]) == 2
    assert install(moved)[1] == []


def test_make_without_a_python_says_so_in_one_line(clone):
    answer, pip = clone[1](too_old=1)
    assert answer.returncode == 2 and pip == []
    says = r"Makefile:\d+: \*\*\* this course needs Python 3.11 to 3.15 .+\n"
    assert re.fullmatch(says, answer.stderr)
