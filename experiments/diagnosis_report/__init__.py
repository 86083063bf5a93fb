"""Shows a diagnosis: ten lines on the console, an HTML page, and a Rerun file."""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from experiments.diagnosis_report.console import console_lines, print_verdict
    from experiments.diagnosis_report.overlay import write_overlay
    from experiments.diagnosis_report.page import ReportFacts, write_report

__all__ = [
    "ReportFacts",
    "console_lines",
    "print_verdict",
    "write_overlay",
    "write_report",
]

__getattr__ = lazy_face(
    __name__,
    {
        "console": ["console_lines", "print_verdict"],
        "overlay": ["write_overlay"],
        "page": ["ReportFacts", "write_report"],
    },
)
"""Imports a module of this package when one of its names is first used, so that
Matplotlib and Rerun are not loaded needlessly."""
