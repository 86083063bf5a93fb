"""Physics that MuJoCo lacks, step by step: what `corrected_laws.py` is made of.

A run folder gets these classes as one file, see `laws_file`. So they need NumPy and
MuJoCo only, know nothing of this project, and compute one joint or body at a time, in
plain numbers, to be read. `diagnosis.replay` computes the same for many simulations at
once; tests compare the two.
"""
