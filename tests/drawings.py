"""Whether a picture shows something."""

import numpy as np
from PIL import Image


def is_drawn(path):
    """Return whether a PNG has more in it than axes and their labels: ink, and colours."""
    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    ink = (pixels < 250).any(axis=-1).mean()
    colours = (np.ptp(pixels, axis=-1) > 30).mean()
    return bool(ink > 0.05 and colours > 0.001)
