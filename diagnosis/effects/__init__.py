"""Effects: kinds of physics that a sim may lack. `library` lists those built in.

An effect's class holds all that a diagnosis needs to know of it. A new built-in effect
is a class here, one line in `library`, and a second implementation for test worlds in
`worlds.hidden.effects`. An effect of your own only needs `also_known`.
"""

from diagnosis.effects.effect import Effect, TorqueEffect
from diagnosis.effects.library import all_effects, also_known, effect
from diagnosis.effects.parts import EffectWords, JointMotion, Parameter, PlacedEffect
from diagnosis.effects.variants import Variants

__all__ = [
    "Effect",
    "EffectWords",
    "JointMotion",
    "Parameter",
    "PlacedEffect",
    "TorqueEffect",
    "Variants",
    "all_effects",
    "also_known",
    "effect",
]
