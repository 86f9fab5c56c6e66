import sys
from pathlib import Path

import numpy as np
import pytest

from tusqh.geometry.outline import Outline

REPOSITORY = Path(__file__).resolve().parent.parent

sys.path.insert(0, str(Path(__file__).parent))  # for `import oracles` and `fields`


@pytest.fixture(scope="session")
def repository() -> Path:
    return REPOSITORY


@pytest.fixture
def square() -> Outline:
    """The unit square, counter-clockwise."""
    return Outline.from_chains(
        [np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])], name="square"
    )
