import pytest

from experiments.runs.progress import Stages, progress


def test_a_tenth_of_the_work_is_a_line(capsys):
    with progress("walks", 40) as task:
        for _ in range(40):
            task.advance()
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 10
    assert lines[0].startswith("walks 4/40, ")
    assert lines[-1].startswith("walks 40/40, 0 s left")


def test_stages_follow_one_another_and_each_is_finished(capsys):
    with Stages("diagnosis", threads=2) as stages:
        stages.stage("audit", 1)
        stages.advance()
        stages.stage("search round 1", 50)
        stages.advance(20)  # fewer steps than were expected
        stages.stage("test", 10)
        stages.advance(30)  # more
    ends = [line.split(",")[0] for line in capsys.readouterr().err.splitlines()]
    assert ends == [
        "audit 1/1",
        "search round 1 20/50",
        "search round 1 50/50",
        "test 10/10",
    ]


@pytest.mark.parametrize(
    ("seconds", "threads", "said"),
    [
        (59.0, 2, ""),
        (70.0, 1, "diagnosis: about 1 minute on 1 thread\n"),
        (240.0, 2, "diagnosis: about 4 minutes on 2 threads\n"),
    ],
)
def test_the_cost_is_said_where_it_is_more_than_a_minute(
    capsys, seconds, threads, said
):
    with Stages("diagnosis", threads) as stages:
        stages.cost(seconds)
    assert capsys.readouterr().err == said
