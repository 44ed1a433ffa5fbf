"""The tools of the pages, which are no package."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "docs" / "extensions"), str(ROOT / "docs")]
