"""The check on the first page: what it says where something is missing."""

import os

import pytest

import arkaq_edu as ae
from arkaq_edu import _installation


def test_a_whole_installation_passes(capsys):
    ae.check_installation()
    assert capsys.readouterr().out == "Everything is there. The course can run.\n"


def test_a_missing_and_an_old_package_are_named_with_what_to_do(capsys, monkeypatch):
    needs = ["no-such-package>=1", "numpy>=99", "pymunk>=1", 'also-missing; extra == "bench"']
    monkeypatch.setattr(_installation, "requires", lambda name: needs)
    ae.check_installation()
    missing, old = capsys.readouterr().out.splitlines()
    assert missing.startswith("no-such-package is missing: run `make install`")
    assert "but the course needs numpy>=99" in old


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tmp_path.chmod(0o500)
    ae.check_installation()
    assert f"Nothing can be saved in {tmp_path}" in capsys.readouterr().out


def test_lost_data_are_named(capsys, monkeypatch):
    def gone(name):
        raise FileNotFoundError(name)

    monkeypatch.setattr(_installation, "data_file", gone)
    ae.check_installation()
    assert "The recorded data of the course are missing" in capsys.readouterr().out
