"""The card of the algorithm passes: laws, agreement and claims."""

import subprocess
import sys
from pathlib import Path

ALGORITHM = Path(__file__).parents[1] / "my_algorithm.py"


def test_the_card_passes(tmp_path: Path) -> None:
    """Exit code 0 of ``footprint card --check``."""
    command = [sys.executable, "-m", "studies.cli", "card", str(ALGORITHM), "--check", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
