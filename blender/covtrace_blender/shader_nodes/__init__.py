"""Values of Blender's shader nodes at many places of a surface at once, by numpy.

Nothing here imports Blender: nodes, sockets and images are whatever has the attributes of Blender's own, so that all
of it can be tried without Blender. Numbers are arrays of shape (n,), colours and vectors of shape (n, 3), both
float32; without their first axis they are the same everywhere.
"""
