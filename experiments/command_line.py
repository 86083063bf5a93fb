"""The command `groundwalk`: its verbs, parsing of their options, error messages."""

import contextlib
import functools
import importlib
import io
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, NoReturn

from groundwalk.errors import GroundwalkError, UnknownNameError


class Verb(NamedTuple):
    """Where the code of a verb of the command line is, and a summary of the verb.

    Attributes:
      config: name, in the verb's module, of the dataclass of its options, or of a table
        (dict of `Verb`) of the verb's own verbs.
      summary: a few words for the list of verbs.
      module: the module in the package experiments; by default named like the verb.

    Example:
      >>> Verb("Export", "write a robot as MJCF or URDF").config
      'Export'
    """

    config: str
    summary: str
    module: str = ""


VERBS = {
    "optimize-gait": Verb(
        "OptimizeGait", "tune a gait in the sim, try it in both worlds"
    ),
    "evaluate": Verb("Evaluate", "measure speed and falls of gaits"),
    "humanoids": Verb("Humanoids", "tune gaits for other humanoids"),
    "terrain-stress": Verb(
        "TerrainStress", "find the roughest ground that gaits can walk"
    ),
    "transfer": Verb("STUDIES", "repeat an experiment of the SGAT paper"),
    "check": Verb(
        "CheckRecordings", "what recordings can show, and what to record next"
    ),
    "diagnose": Verb("Diagnose", "find the physics that a sim lacks, from recordings"),
    "predict": Verb("Predict", "check a diagnosis on recordings that it has not seen"),
    "real-robots": Verb("RealRobots", "diagnose recordings of known real robots"),
    "record": Verb("Record", "make a recording, with hidden physics if wanted"),
    "convert": Verb("Convert", "make recordings from files of ROS, LeRobot and others"),
    "concealed": Verb(
        "STUDIES", "test the diagnosis on recordings with hidden physics"
    ),
    "visualize": Verb("Visualize", "show rollouts and searches in Rerun"),
    "render": Verb("Render", "draw a film strip or a film of walks"),
    "export": Verb("Export", "write a robot as MJCF or URDF"),
    "list": Verb("List", "list the known robots, terrains or gaits", "list_names"),
    "doctor": Verb("DoctorConfig", "report what is installed and what is missing"),
}

BAD_INPUT = 2
"""Exit status after an error that the user can correct; argparse uses 2, too."""

INTERRUPTED = 130
"""Exit status after Ctrl-C, as in shells: 128 + SIGINT."""


def main() -> None:
    """Run the verb that the command line names."""
    choose(VERBS, "groundwalk", sys.argv[1:])


def choose(
    verbs: Mapping[str, Verb],
    program: str,
    arguments: Sequence[str],
    kind: str = "verb",
) -> None:
    """Run the verb that the first argument names; only its module is imported.

    A verb may have verbs of its own, called studies. `program` is the command up to
    here, such as "groundwalk concealed"; `kind` is what the help calls a verb.
    """
    name, *options = arguments or ["--help"]
    if name in ("-h", "--help"):
        print(f"usage: {program} {kind.upper()} [options]\n")
        for known, verb in verbs.items():
            print(f"  {known:18}{verb.summary}")
        print(f"\n{program} {kind.upper()} --help shows the options of a {kind}")
        return
    verb = _guarded(lambda: _verb(kind, name, verbs))
    module = importlib.import_module(home(name, verb))
    config = getattr(module, verb.config)
    if isinstance(config, dict):
        choose(config, f"{program} {name}", options, "study")
    else:
        run_verb(config, module.main, f"{program} {name}", options)


def home(name: str, verb: Verb) -> str:
    """The full name of a verb's module."""
    return f"experiments.{verb.module or name.replace('-', '_')}"


def run_verb(
    config_type: Any,
    verb: Callable[[Any], object],
    program: str | None = None,
    arguments: list[str] | None = None,
) -> NoReturn:
    """Parse a verb's options (by default those of the process), do its work, and exit.

    After Ctrl-C the text `if_interrupted` of the options' dataclass, if any, says how
    to continue. An integer that the verb returns is the exit status.
    """
    config = _parse(config_type, program, arguments)
    hint = getattr(config_type, "if_interrupted", "")
    status = _guarded(lambda: verb(config), if_interrupted=hint)
    sys.exit(status if isinstance(status, int) else 0)


def run_script(main: Callable[..., object]) -> None:
    """Run a function as a script whose command-line options are its arguments.

    These have types, and are described in its docstring. Errors that the user can
    correct are printed as one line, with exit status 2.

    Example:
      >>> if __name__ == "__main__":
      ...     run_script(main)
    """
    import tyro

    _guarded(lambda: tyro.cli(main))


def one_line(report: str) -> str:
    """Turn an error report of tyro, the option parser, into one line without hints."""
    lines = []
    for line in report.splitlines():
        text = line.strip("│╭╮╰╯─ ")
        if text.startswith("For full helptext"):
            break
        if text and not line.startswith(("╭", "╰")):
            lines.append(text)
    return " ".join(lines)


def _verb(kind: str, name: str, verbs: Mapping[str, Verb]) -> Verb:
    if name not in verbs:
        raise UnknownNameError(kind, name, verbs)
    return verbs[name]


def _parse(config_type: Any, program: str | None, arguments: list[str] | None) -> Any:
    import tyro

    # tyro shows inherited options of a class first, those of a call in their order.
    config = functools.partial(config_type)
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            return _guarded(
                lambda: tyro.cli(config, prog=program, args=arguments), said.write
            )
    except SystemExit as stop:
        if stop.code:
            _tell(one_line(said.getvalue()))
        raise


def _tell(message: str) -> None:
    print(f"groundwalk: {message}", file=sys.stderr)


def _guarded(
    work: Callable[[], Any],
    tell: Callable[[str], object] = _tell,
    if_interrupted: str = "",
) -> Any:
    """Call `work`; for an error that the user can correct print a line and exit."""
    try:
        return work()
    except (GroundwalkError, OSError) as error:
        tell(str(error))
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        tell(f"interrupted{if_interrupted}")
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
