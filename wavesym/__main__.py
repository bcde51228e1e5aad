"""`python -m wavesym` is `wavesym`."""

import sys

from wavesym.cli import main

sys.exit(main())
