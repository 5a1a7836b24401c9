"""An independent renderer, Blender Cycles, beside ours: is the light right, and what does it cost?

Both sides read the same neutral scene and the same job, each in a process of its own, since
Cycles needs an environment of its own (``make oracle``, ``make speed``).
"""
