"""Every module comes in, also beside the oldest and the newest versions of the libraries."""

import importlib
import pkgutil

import arkaq_edu


def test_every_module_is_imported():
    found = [each.name for each in pkgutil.walk_packages(arkaq_edu.__path__, "arkaq_edu.")]
    assert len(found) > 100
    for name in found:
        assert importlib.import_module(name).__doc__, name
