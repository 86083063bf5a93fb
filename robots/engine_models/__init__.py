"""MuJoCo and PyBullet models made from a description.

`mujoco_spec` makes a robot's MuJoCo model, `urdf` the URDF for PyBullet. `model_urdf`
turns a compiled MuJoCo model into a URDF, `heavier_bodies` changes its masses;
`inverse_dynamics` says what a motion takes.
"""
