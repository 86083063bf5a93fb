"""Physics that a hidden world can have and its nominal model lacks, one class a kind.

The kinds carry the names and units of the diagnosis' effects, but their physics is
written here a second time and independently of `diagnosis`, so that the benchmark does
not test the diagnosis against its own code.

To add a kind, write a subclass of `HiddenKind` into a new module of this package:
modules are found by themselves, and nothing else has to be edited.

Example:
  >>> from worlds.hidden.effects import KINDS, Hidden
  >>> play = Hidden.parse("backlash@LKneePitch:gap=0.02")
  >>> play["gap"], KINDS["backlash"].parameters["gap"].unit
  (0.02, 'rad')
"""

from worlds.hidden.effects.kind import HiddenKind, Quantity
from worlds.hidden.effects.placed import KINDS, Hidden, surroundings

__all__ = ["KINDS", "Hidden", "HiddenKind", "Quantity", "surroundings"]
