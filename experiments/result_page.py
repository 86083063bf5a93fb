"""A run's results as a page of Markdown: every number written by the run itself."""

from collections.abc import Mapping
from typing import Any

from experiments.intervals import wilson
from experiments.run_folder import CONFIG, PROVENANCE, RESULT, RunFolder
from experiments.score_table import Scores
from walk_engine import PARAMETERS

PAGE = "result.md"


def write_page(folder: RunFolder, title: str, scores: Scores) -> None:
    """Write `result.md` into a run folder that has its result.

    Args:
      folder: the run.
      title: what was asked, as a heading.
      scores: by world and gait.
    """
    provenance, config = folder.read_json(PROVENANCE), folder.read_json(CONFIG)
    result = folder.read_json(RESULT)
    lines = [f"# {title}", "", *origin(provenance, config), "", *score_lines(scores)]
    if "gait" in result:
        lines += ["", "## The tuned gait", "", *gait_lines(result["gait"])]
    folder.write_text(PAGE, "\n".join(lines) + "\n")


def origin(provenance: Mapping[str, Any], config: Mapping[str, Any]) -> list[str]:
    """Which command made these numbers, from which code."""
    commit = provenance["commit"] or "unknown"
    changed = ", with changes that were not committed" if provenance["changed"] else ""
    versions = ", ".join(
        f"{name} {number}" for name, number in provenance["packages"].items() if number
    )
    command = " ".join(["groundwalk", *provenance["arguments"]])
    return [
        f"- command: `{command}`",
        f"- commit: `{commit}`{changed}; seed {config['seed']}",
        f"- versions: Python {provenance['python']}, {versions}",
    ]


def score_lines(scores: Scores) -> list[str]:
    """A table of speeds with their spread, and of falls with Wilson's interval."""
    lines = [
        "| world | gait | speed [cm/s] ± s.d. | falls | fall rate, 95 % interval |",
        "|---|---|---|---|---|",
    ]
    for world, gaits in scores.items():
        for gait, score in gaits.items():
            low, high = wilson(score["falls"], score["trials"])
            lines.append(
                f"| {world} | {gait} | {score['speed_cm_s']:.1f} ± "
                f"{score['speed_std']:.1f} | {score['falls']}/{score['trials']} | "
                f"{low:.0%} to {high:.0%} |"
            )
    return lines


def gait_lines(gait: Mapping[str, float]) -> list[str]:
    """A table of a gait's parameters beside the constants of 2014."""
    lines = ["| parameter | unit | 2014 | tuned |", "|---|---|---|---|"]
    return lines + [
        f"| {p.name} | {p.unit} | {p.default:g} | {gait[p.name]:.4g} |"
        for p in PARAMETERS
    ]
