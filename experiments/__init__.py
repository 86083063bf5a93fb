"""Studies and the command line: the only package that may import all the others.

The names in `__all__` are for use from Python (see docs/python.md). A name's module is
imported when the name is first used, so that each verb loads no more than it needs.
"""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from experiments.command_line import run_script
    from experiments.diagnose import Diagnose, run_diagnosis
    from experiments.diagnosis_report.console import print_verdict
    from experiments.optimize_gait import OptimizeGait, tune_gait
    from experiments.predict import Predict, predict_recordings
    from experiments.record import Record, make_recording

__all__ = [
    "Diagnose",
    "OptimizeGait",
    "Predict",
    "Record",
    "make_recording",
    "predict_recordings",
    "print_verdict",
    "run_diagnosis",
    "run_script",
    "tune_gait",
]

__getattr__ = lazy_face(
    __name__,
    {
        "command_line": ["run_script"],
        "diagnose": ["Diagnose", "run_diagnosis"],
        "diagnosis_report.console": ["print_verdict"],
        "optimize_gait": ["OptimizeGait", "tune_gait"],
        "predict": ["Predict", "predict_recordings"],
        "record": ["Record", "make_recording"],
    },
)
