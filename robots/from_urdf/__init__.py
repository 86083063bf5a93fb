"""Descriptions of humanoids made from URDFs: legs, soles, motors and size.

`robots.get` is the way in; nothing of this shelf is needed by others, but the readers
of mesh files and `package://` paths.
"""
