"""Kinds of hidden physics, one class each: what a nominal robot model lacks.

Names and units are those of the effects in `diagnosis`, but the physics is written here
a second time, so that benchmarks do not test the diagnosis against its own code.

To add a kind, write a subclass of `kind.HiddenKind` in a new module of this package;
all modules here are imported and searched, so nothing else has to be edited.

Example:
  >>> from worlds.hidden.effects import KINDS, Hidden
  >>> play = Hidden.parse("backlash@LKneePitch:gap=0.02")
  >>> play["gap"], KINDS["backlash"].parameters["gap"].unit
  (0.02, 'rad')
"""

from worlds.hidden.effects.placed import KINDS, Hidden, surroundings

__all__ = ["KINDS", "Hidden", "surroundings"]
