import pytest

from experiments.runs.extras import extra


def test_a_failure_is_one_line_that_names_the_file(capsys):
    with extra("walk.png"):
        raise ValueError("two\nlines")
    assert capsys.readouterr().err == "groundwalk: walk.png is not written: two lines\n"


def test_a_failure_without_a_message_says_what_it_was(capsys):
    with extra("walk.png"):
        raise MemoryError
    assert "MemoryError" in capsys.readouterr().err


def test_what_works_says_nothing(capsys):
    with extra("walk.png"):
        pass
    assert capsys.readouterr() == ("", "")


def test_an_interruption_passes_through():
    with pytest.raises(KeyboardInterrupt), extra("walk.png"):
        raise KeyboardInterrupt
