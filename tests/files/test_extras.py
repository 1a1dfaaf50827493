"""Test of the command that installs the packages of an extra."""

import tomllib
from pathlib import Path

import pytest

from foreride.files.extras import install_command

PROJECT = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())["project"]


@pytest.mark.parametrize("extra", ["sweep", "training", "openvino", "docs"])
def test_the_command_names_the_packages_of_the_extra_alone(extra: str) -> None:
    words = install_command(extra).replace("'", "").split()
    assert words[:2] == ["pip", "install"]
    assert sorted(words[2:]) == sorted(PROJECT["optional-dependencies"][extra])
