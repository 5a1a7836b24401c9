"""``python -m bench``: the command line, where its script is not on the path."""

import sys

from bench.cli import main

sys.exit(main())
