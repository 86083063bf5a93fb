"""Grounding: makes a simulator behave like the real world, by changing its actions.

GAT and SGAT (Desai et al. 2020) and their kin. What an action does in the real world
is learnt from real transitions, and each action is replaced by the one that does the
same in the simulator. Files of this room are imported by name, so that nobody pays
for what he does not use: `tabular_*` need NumPy only.
"""
