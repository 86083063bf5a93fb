"""The effects, one file each; `diagnosis.effects.library` lists them."""
