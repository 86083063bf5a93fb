"""Effects: kinds of physics that a sim may lack. `library` lists those built in.

An effect's class holds all that a diagnosis needs to know of it. A new built-in effect
is a class here, one line in `library`, and a second implementation for test worlds in
`worlds.hidden.effects`. An effect of your own only needs `also_known`.
"""

from diagnosis.effects.base_kinds import TorqueEffect as TorqueEffect
from diagnosis.effects.effect import Effect as Effect
from diagnosis.effects.library import all_effects as all_effects
from diagnosis.effects.library import also_known as also_known
from diagnosis.effects.library import effect as effect
from diagnosis.effects.library import keys_within as keys_within
from diagnosis.effects.parts import EffectWords as EffectWords
from diagnosis.effects.parts import JointMotion as JointMotion
from diagnosis.effects.parts import Parameter as Parameter
from diagnosis.effects.parts import PlacedEffect as PlacedEffect
from diagnosis.effects.variants import Variants as Variants
