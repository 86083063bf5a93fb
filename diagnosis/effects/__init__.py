"""The effects, one file each; `diagnosis.library` lists them."""
