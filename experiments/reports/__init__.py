"""Reports: pages in Markdown and HTML, tables on the console, statistics, figures."""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from experiments.reports.origin import Origin
    from experiments.reports.report import Report, markdown_table
    from experiments.reports.statistics import half_fall, wilson
    from experiments.reports.tables import print_table

__all__ = [
    "Origin",
    "Report",
    "half_fall",
    "markdown_table",
    "print_table",
    "wilson",
]

__getattr__ = lazy_face(
    __name__,
    {
        "origin": ["Origin"],
        "report": ["Report", "markdown_table"],
        "statistics": ["half_fall", "wilson"],
        "tables": ["print_table"],
    },
)
"""Imports a module of this package when one of its names is first used, so that
`groundwalk doctor` works without any installed package."""
