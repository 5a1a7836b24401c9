"""What every test runs under: one thread for tiny matrices, no deadline on shared cores."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is loaded; see bench/__init__.py

from hypothesis import settings

# A deadline measures the machine. Elsewhere each run draws other examples; CI must not differ from
# one run to the next for the same code.
settings.register_profile("house", deadline=None)
settings.register_profile("ci", parent=settings.get_profile("house"), derandomize=True)
settings.load_profile("ci" if "CI" in os.environ else "house")
