"""Grounding: makes a simulator behave like the real world, by changing its actions.

Grounded action transformation (GAT, Hanna and Stone 2017), its stochastic version
(SGAT, Desai et al. 2020) and variants. Models learn from real transitions what an
action does in the real world; each action is then replaced by the one that has the same
effect in the simulator. The subpackages:

- `sgat.models`: forward and inverse models, small networks.
- `sgat.transformers`: action transformers, which replace actions; methods to make them.
- `sgat.walks`: grounding of worlds in which robots walk.
- `sgat.gym`: grounding of Gymnasium environments.
- `sgat.tabular`: grounding of finite worlds, where every model is a table.
"""
