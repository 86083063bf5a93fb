"""Where a page comes from: the command that repeats it, settings and versions."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from experiments.runs.folder import CONFIG, PROVENANCE, RunFolder
from experiments.runs.repeat_command import NOT_REPEATED


@dataclass(frozen=True)
class Origin:
    """What made a page, in words.

    Attributes:
      command: the command line that does it again.
      commit: of the code, whether there were changes beside it, and those at which
        the run was resumed.
      settings: what was chosen, by name; all of it, defaults, too.
      versions: of the code and what it stands on, by name.
    """

    command: str
    commit: str
    settings: Mapping[str, str]
    versions: Mapping[str, str]

    @classmethod
    def of(cls, provenance: Mapping[str, Any], settings: Mapping[str, Any]) -> Self:
        """Of what a run wrote down.

        Args:
          provenance: of the run.
          settings: plain values; what is None is left out.
        """
        known = [provenance, *provenance.get("resumed", ())]
        versions = {
            "groundwalk": provenance.get("groundwalk"),
            "Python": provenance["python"],
            **provenance["packages"],
        }
        return cls(
            command=command_of(provenance),
            commit="; resumed at ".join(map(_code, known)),
            settings={k: _text(v) for k, v in settings.items() if v is not None},
            versions={k: v for k, v in versions.items() if v},
        )

    @classmethod
    def of_run(cls, folder: RunFolder) -> Self:
        """Of a run's folder.

        Raises:
          RunFolderError: the folder does not say where it comes from.
        """
        config = folder.read_json(CONFIG)
        chosen = {k: v for k, v in config.items() if k not in {"verb", *NOT_REPEATED}}
        return cls.of(folder.read_json(PROVENANCE), chosen)

    def rows(self) -> list[tuple[str, str]]:
        """Everything but the command: names and values."""
        return [*self.settings.items(), ("commit", self.commit), *self.versions.items()]

    def to_markdown(self) -> list[str]:
        """A list, in few lines."""
        settings = ", ".join(f"{name} {value}" for name, value in self.settings.items())
        versions = ", ".join(f"{name} {value}" for name, value in self.versions.items())
        return [
            f"- command: `{self.command}`",
            f"- settings: {settings or 'none'}",
            f"- commit: `{self.commit}`",
            f"- versions: {versions}",
        ]


def _code(provenance: Mapping[str, Any]) -> str:
    changed = ", with changes that were not committed"
    return (provenance["commit"] or "unknown") + changed * bool(provenance["changed"])


def command_of(provenance: Mapping[str, Any]) -> str:
    """The command line of a run; early ones wrote down its arguments alone."""
    known = provenance.get("command")
    return str(known or shlex.join(["groundwalk", *provenance["arguments"]]))


def _text(value: Any) -> str:
    if isinstance(value, str) or not isinstance(value, Sequence):
        return str(value)
    return ", ".join(map(_text, value)) or "none"
