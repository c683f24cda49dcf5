"""``python -m rockshed``: the command line.

Python puts the working folder first where modules are looked for. What lies there is a user's, or
somebody else's, and is not imported.
"""

import sys

if not sys.flags.safe_path:
    del sys.path[0]

from .commands.app import main

if __name__ == "__main__":
    main()
