import importlib

import pytest

from experiments.command_line import choose
from experiments.transfer import STUDIES


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_is_there(name):
    module = importlib.import_module(f"experiments.{STUDIES[name].module}")
    assert callable(module.main)
    assert getattr(module, STUDIES[name].config)().seed == 1


def test_help_names_every_study(capsys):
    choose(STUDIES, "groundwalk transfer", ["--help"], "study")
    said = capsys.readouterr().out
    assert said.startswith("usage: groundwalk transfer STUDY")
    assert all(name in said for name in STUDIES)


def test_a_misspelt_study_gets_one_line(capsys):
    with pytest.raises(SystemExit) as stop:
        choose(STUDIES, "groundwalk transfer", ["clif"], "study")
    assert stop.value.code == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert "unknown study 'clif': did you mean 'cliff'" in said.err
