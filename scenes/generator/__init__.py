"""Builds the project's own scenes: meshes, textures, environment maps and pbrt-v4 text."""
