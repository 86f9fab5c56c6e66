"""Read damaged files, each in a separate limited process: ``python fuzzing.py FIRST COUNT``.

File number k is always damaged in the same way.  One JSON object is printed for each fault, and a
count of the others.  ``--only '*.3mf'`` damages the samples of one format, ``--keep FOLDER`` keeps
the files that show a fault.
"""

import argparse
import json
import math
import os
import re
import resource
import signal
import tempfile
import traceback
from collections import Counter
from importlib import import_module
from pathlib import Path

import numpy as np
from samples import LENGTHS, OPTIONS, write_samples

from tusqh.errors import TusqhError
from tusqh.geometry.image import Image
from tusqh.pipeline.describe_reading import describe_reading
from tusqh.readers.files import read_file
from tusqh.readers.formats import FORMATS

SECONDS, MEMORY = 20, 2 << 30
NUMBERS = (b"0", b"-1", b"1e308", b"nan", b"999999999", b"4294967295", b"99999999999999999999", b"")


def cut(content, rng):
    return content[: rng.integers(len(content))]


def flip(content, rng):
    data = np.frombuffer(content, dtype=np.uint8).copy()
    for place in rng.integers(len(data), size=rng.integers(1, 9)):
        data[place] ^= 1 << rng.integers(8)
    return data.tobytes()


def flip_head(content, rng):
    n = min(len(content), 200)
    return flip(content[:n], rng) + content[n:]


def blocks(content, rng):
    """Return the content in four pieces of random lengths."""
    a, b, c = np.sort(rng.integers(len(content) + 1, size=3))
    return content[:a], content[a:b], content[b:c], content[c:]


def swap(content, rng):
    first, second, third, last = blocks(content, rng)
    return first + third + second + last


def repeat(content, rng):
    first, second, third, last = blocks(content, rng)
    return first + second + second + third + last


def drop(content, rng):
    first, _, third, last = blocks(content, rng)
    return first + third + last


def blank(content, rng):
    first, second, third, last = blocks(content, rng)
    return first + bytes([rng.choice([0, 32, 255])]) * len(second) + third + last


def renumber(content, rng):
    """Replace one of the numbers in a text."""
    found = list(re.finditer(rb"\d+(?:\.\d+)?", content))
    if not found:
        return flip(content, rng)
    chosen = found[rng.integers(len(found))]
    return content[: chosen.start()] + NUMBERS[rng.integers(8)] + content[chosen.end() :]


DAMAGES = (cut, flip, flip_head, swap, repeat, drop, blank, renumber)


def damage(samples, number):
    """Return a sample, the name of its damage, and its damaged content."""
    rng = np.random.default_rng(number)
    path = samples[number % len(samples)]
    change = DAMAGES[rng.integers(len(DAMAGES))]
    return path, change.__name__, change(path.read_bytes(), rng)


def stated_points(path):
    """Return how many points or voxels a file states; None where it does not, or not simply."""
    content = path.read_bytes()
    if path.name == "binary.stl":
        return 3 * int.from_bytes(content[80:84], "little")
    if path.suffix == ".ply":
        found = re.findall(rb"element +vertex +(\d+)", content.partition(b"end_header")[0])
        return int(found[-1]) if len(found) == 1 else None
    if path.suffix == ".npy":
        return math.prod(np.load(path, mmap_mode="r").shape)
    if path.suffix == ".nrrd":
        found = re.findall(rb"^sizes: *([\d ]+)$", content.partition(b"\n\n")[0], re.MULTILINE)
        return math.prod(map(int, found[0].split())) if len(found) == 1 else None
    if path.suffix == ".csv":
        return 2 * (len([row for row in content.split(b"\n") if row.strip()]) - 1)
    return None


def read(path):
    """Read a file and return what happened."""
    try:
        reading = read_file(path, image=OPTIONS.get(path.suffix), lengths=LENGTHS.get(path.suffix))
        describe_reading(reading)
    except TusqhError as error:
        is_complete = all((error.found, error.where, error.expected, error.remedy))
        return {"end": "refused" if is_complete else "incomplete message", "found": error.found}
    except BaseException:
        return {"end": "traceback", "found": traceback.format_exc()}
    geometry = reading.geometry
    n = geometry.voxels.size if isinstance(geometry, Image) else len(geometry.points)
    stated = stated_points(path)
    is_same = stated in (None, n) or any(r.effect != "noted" for r in reading.remarks)
    return {"end": "read" if is_same else "other counts", "found": f"{n}, stated {stated}"}


def read_apart(path):
    """Read a file in a child process with limits, and return what happened."""
    here, there = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(here)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY,) * 2)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.alarm(SECONDS)
        result = read(path)
        os.write(there, json.dumps(result).encode()[:60000])
        os._exit(0)
    os.close(there)
    with os.fdopen(here, "rb") as pipe:
        text = pipe.read()
    _, status, usage = os.wait4(child, 0)
    if os.WIFSIGNALED(status):
        name = signal.Signals(os.WTERMSIG(status)).name
        return {"end": "hang" if name == "SIGALRM" else "crash", "found": name}
    if usage.ru_maxrss > MEMORY // 1024:
        return {"end": "memory", "found": f"{usage.ru_maxrss} kB"}
    return json.loads(text)


def main(first, count, only, kept):
    """Read some files, and keep those that are faults."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        samples = [path for path in write_samples(folder) if path.match(only)]
        for path in samples:
            read_file(
                path, image=OPTIONS.get(path.suffix), lengths=LENGTHS.get(path.suffix)
            )  # This loads every library, so that no child has to.
        for found in FORMATS:
            import_module(f"tusqh.readers.{found.module}")
        ends = Counter()
        for number in range(first, first + count):
            sample, change, content = damage(samples, number)
            path = folder / "damaged" / sample.name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(content)
            result = read_apart(path) | {"number": number, "file": sample.name, "change": change}
            ends[result["end"]] += 1
            if result["end"] not in ("read", "refused"):
                print(json.dumps(result), flush=True)
                if kept:
                    Path(kept, f"{number}_{sample.name}").write_bytes(content)
        print(json.dumps(ends))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--only", default="*")
    parser.add_argument("--keep")
    given = parser.parse_args()
    main(given.first, given.count, given.only, given.keep)
