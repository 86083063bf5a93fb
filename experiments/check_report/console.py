"""Prints a check of recordings."""

from diagnosis.check.result import Check
from experiments.check_report.words import (
    CAREFUL,
    NOISE,
    RECORDINGS,
    finding_lines,
    lost_sentences,
    noise_rows,
    proposed_lines,
    recording_rows,
    size_tables,
    verdict_sentence,
    without_empty,
)
from experiments.reports.tables import print_table


def print_check(found: Check, is_written: bool) -> None:
    """Print what recordings are good for.

    `is_written` says whether the proposed motions were written into files.
    """
    print_table(RECORDINGS, recording_rows(found))
    for severity, text in finding_lines(found):
        print(f"{severity}: {text}")
    print("", verdict_sentence(found), "", sep="\n")
    if not found.usable:
        return
    print_table(NOISE, noise_rows(found))
    print("\nThe smallest sizes that would be told:")
    for columns, rows in size_tables(found):
        print()
        print_table(*without_empty(columns, rows))
    for title, said in (
        ("What cannot be told:", lost_sentences(found)),
        ("What to record next:", proposed_lines(found)),
    ):
        if said:
            print("", title, *(f"- {one}" for one in said), sep="\n")
    if found.proposed:
        print(f"\n{CAREFUL}")
    if found.proposed and not is_written:
        print("With --out FOLDER these motions are written as files to play.")
