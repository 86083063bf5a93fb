"""Options that make commands small, what they write, and steps of many pages."""

from kinds_of_steps import NotRun

SHORT = "--trials 1 --course-m 0.3"
SEARCH = f"--population 4 --generations 1 --ratings 1 {SHORT}"
FILM = "--duration 0.3 --width 64 --height 64"
SMALL_STUDY = (
    "--trials 2 --course-m 0.3 --population 4 --generations 1 --ratings 1 "
    "--repeats 1 --real-walks 2 --more-real-walks 2 --sim-walks 2 "
    "--real-population 4 --real-generations 1"
)
TUNED = (
    "report.html", "result.json", "result.md", "config.json", "provenance.json",
    "history.json", "walk.rrd", "walk.png", "search.png", "recordings/*.parquet",
)  # fmt: skip
CONCEALED = ("set/cases/case_000/**/*.parquet", "set/sealed.sha256")
PREDICTED = (
    "report.html", "result.json", "result.md", "audit.json", "config.json",
    "provenance.json", "channel_1.png",
)  # fmt: skip
CORRECTED = (
    "corrected.xml", "corrected.json", "corrected_laws.py", "test_corrected_laws.py",
)  # fmt: skip
DIAGNOSED = ("report.html", "diagnosis.json", "audit.json", "overlay.rrd")


TESTS = NotRun("minutes, beside this test", "make -n test", says="--ignore")
SLOW_TESTS = NotRun("a quarter of an hour", "make -n slow-tests", says="-m slow")
IT_RUNS_THIS = NotRun("it runs this test", "make -n journeys", says="tests/journeys")

REAL = NotRun(
    "minutes to an hour, with recordings of real robots that are not in the repository",
    "groundwalk real-robots so101 --data nowhere",
    status=2,
    says="nowhere",
)
"""Without the recordings there is one clear line."""
