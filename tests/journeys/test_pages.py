"""What the pages tell people to type works: each command, in the order of its page."""

import pytest
from foreign_things import write_foreign_things
from kinds_of_steps import NotRun, Run
from made_up_urdf import two_legged
from own_arm import write_own_arm, write_own_episodes
from steps import JOURNEYS, PYTHON_AFTERWARDS
from travel import ROOT, take
from typed_pages import PAGES, blocks, typed

pytestmark = pytest.mark.slow

TYPED = [page for page in PAGES if typed(page)]


@pytest.mark.parametrize("page", TYPED, ids=lambda page: page.name)
def test_a_page(page, tmp_path):
    """Readers begin in a clone: what it holds of docs/results is there,
    and so are the URDF of a robot of their own and files of other programs.
    What the page shows as printed is printed."""
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    (tmp_path / "my_robot.urdf").write_text(two_legged())
    write_foreign_things(tmp_path)
    write_own_arm(tmp_path)
    write_own_episodes(tmp_path)
    printed = [take(tmp_path, one, JOURNEYS[page.name][one]) for one in typed(page)]
    lines = {unpadded(line) for one in printed for line in one.splitlines()}
    shown = [line for block in blocks(page, "text") for line in block.splitlines()]
    assert [line for line in shown if unpadded(line) not in lines | {""}] == []
    if page.name in PYTHON_AFTERWARDS:
        codes, told = blocks(page, "python"), PYTHON_AFTERWARDS[page.name]
        for code, says in zip(codes, told, strict=True):
            (tmp_path / "typed.py").write_text(code)
            take(tmp_path, "python typed.py", Run(says=says))


def unpadded(line):
    """A printed line, however wide the columns are that a page shows of it."""
    return " ".join(line.split())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_command_of_a_page_belongs_to_its_journey(page):
    """A command that a page gains, loses or changes needs a step here."""
    assert set(JOURNEYS.get(page.name, {})) == set(typed(page))


def test_what_is_not_run_says_why():
    steps = [step for journey in JOURNEYS.values() for step in journey.values()]
    left_out = [step for step in steps if isinstance(step, NotRun)]
    assert all(step.reason and step.brother for step in left_out)
    assert len(left_out) < len(steps) / 2
