"""Triangle meshes as binary PLY files."""

import numpy as np


def write(path, positions, normals, uvs, triangles, tangents=None):
    """positions (n, 3), normals (n, 3) or None, uvs (n, 2) or None, triangles (m, 3), tangents (n, 3) or None."""
    columns, names = [positions], ["x", "y", "z"]
    for values, own in ((normals, "nx ny nz"), (uvs, "u v"), (tangents, "sx sy sz")):
        if values is not None:
            columns.append(values)
            names += own.split()
    vertices = np.hstack(columns).astype("<f4")
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    faces["count"] = 3
    faces["corners"] = triangles
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(vertices.tobytes())
        file.write(faces.tobytes())
