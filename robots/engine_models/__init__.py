"""MuJoCo and PyBullet models made from a description.

`mujoco_spec` and `urdf` make a robot's two models, `model_urdf` turns a compiled MuJoCo
model into a URDF, and `heavier_bodies` changes the masses of one.
"""
