"""``python -m tactus COMMAND``, where the script ``tactus`` is on no path."""

import sys

from tactus.cli.console import main

sys.exit(main())
