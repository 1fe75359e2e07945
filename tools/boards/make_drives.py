#!/usr/bin/env python3
"""make_drives.py BUILD: makes the drives for the boards, in BUILD/board/drives."""
import sys

import drives

if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    drives.make(sys.argv[1])
