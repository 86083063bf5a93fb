"""Descriptions of humanoids made from URDFs: legs, soles, motors and size.

Call `robots.get` to make a description. Other packages import from this one only the
readers of mesh files and of `package://` paths.
"""
