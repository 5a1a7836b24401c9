"""Blender Cycles beside our renderer.

Is our light right, and at what price? Both sides read the same neutral scene and the same job, each
in a process of its own, since Cycles needs an environment of its own (``make oracle``,
``make speed``).
"""
