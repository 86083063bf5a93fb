"""Origin of a report page: the command that repeats its run, settings, versions."""

import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from experiments.runs.folder import CONFIG, PROVENANCE, RunFolder
from experiments.runs.options import NOT_REPEATED


@dataclass(frozen=True)
class Origin:
    """The origin of a report page, as texts.

    Attributes:
      command: the command line that repeats the run.
      commit: the code's git commit, whether there were uncommitted changes, and the
        commits at which the run was resumed.
      settings: values of all options by name, including defaults.
      versions: versions of groundwalk, Python and the packages, by name.
    """

    command: str
    commit: str
    settings: Mapping[str, str]
    versions: Mapping[str, str]

    @classmethod
    def of(cls, provenance: Mapping[str, Any], settings: Mapping[str, Any]) -> Self:
        """Origin of a page, from the content of provenance.json and options by name."""
        changed = ", with changes that were not committed"
        known = [provenance, *provenance.get("resumed", ())]
        versions = {
            "groundwalk": provenance.get("groundwalk"),
            "Python": provenance["python"],
            **provenance["packages"],
        }
        return cls(
            command=command_of(provenance),
            commit="; resumed at ".join(
                (code["commit"] or "unknown") + changed * bool(code["changed"])
                for code in known
            ),
            settings={k: _text(v) for k, v in settings.items() if v is not None},
            versions={k: v for k, v in versions.items() if v},
        )

    @classmethod
    def of_run(cls, folder: RunFolder) -> Self:
        """Read a page's origin (command, settings, versions) from a run's folder."""
        config = folder.read_json(CONFIG)
        chosen = {k: v for k, v in config.items() if k not in {"verb", *NOT_REPEATED}}
        return cls.of(folder.read_json(PROVENANCE), chosen)

    def rows(self) -> list[tuple[str, str]]:
        """Pairs of name and text: all settings, the commit, and all versions."""
        return [*self.settings.items(), ("commit", self.commit), *self.versions.items()]

    def to_markdown(self) -> list[str]:
        """Lines of a Markdown list: command, settings, commit and versions."""
        settings = ", ".join(f"{name} {value}" for name, value in self.settings.items())
        versions = ", ".join(f"{name} {value}" for name, value in self.versions.items())
        return [
            f"- command: `{self.command}`",
            f"- settings: {settings or 'none'}",
            f"- commit: `{self.commit}`",
            f"- versions: {versions}",
        ]


def command_of(provenance: Mapping[str, Any]) -> str:
    """The command line of a run; early provenance.json files hold only arguments."""
    known = provenance.get("command")
    return str(known or shlex.join(["groundwalk", *provenance["arguments"]]))


def shown(text: str) -> str:
    """Make a text a path from the current folder on, if it is an absolute path.

    A page is read on other machines, where folders above this one have other names.
    """
    return os.path.relpath(text) if os.path.isabs(text) else text


def _text(value: Any) -> str:
    """A setting as text."""
    if isinstance(value, str):
        return shown(value)
    if not isinstance(value, Sequence):
        return str(value)
    return ", ".join(map(_text, value)) or "none"
