"""Run the scripts of steps in copies of one process that has imported everything.

A step takes about a second to import the libraries and to load the compiled functions.  This
process does that once, and then forks for every script that `start.py` sends.  A step is still a
process of its own that runs its own script.

The process ends when its standard input is closed, that is when Snakemake has ended.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import json
import os
import runpy
import selectors
import signal
import socket
import sys
import traceback
import warnings
from pathlib import Path

import numba
import numpy as np

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.pipeline.judge import judge
from tusqh.pipeline.persistence import find_persistence
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.settings.policy import Policy

#: Modules that scripts import and that meshing does not.
MODULES = [
    "matplotlib.pyplot",
    "seaborn",
    "snakemake.iocontainers",
    "provenance.record",
    "tusqh.explorer.page",
    "tusqh.overview.page",
    "tusqh.simulate.diffusion",
]


class Steps:
    """The socket, and the steps that run: the connection of each process."""

    def __init__(self, path: Path) -> None:
        self.selector = selectors.DefaultSelector()
        self.running: dict[int, socket.socket] = {}
        self.path = path
        self.listener = socket.socket(socket.AF_UNIX)
        ended, wake = socket.socketpair()
        wake.setblocking(False)
        ended.setblocking(False)
        signal.set_wakeup_fd(wake.fileno())
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        self.own = [self.listener, ended, wake]
        self.selector.register(ended, selectors.EVENT_READ, self.finish)
        self.selector.register(0, selectors.EVENT_READ, self.end)
        self.selector.register(self.listener, selectors.EVENT_READ, self.accept)
        # The file appears under its name when the socket is ready.
        temporary = path.with_suffix(".new")
        self.listener.bind(os.fspath(temporary))
        self.listener.listen(64)
        temporary.rename(path)

    def serve(self) -> None:
        """Start and finish steps until Snakemake has ended."""
        while True:
            for key, _ in self.selector.select():
                key.data(key.fileobj)

    def accept(self, listener: socket.socket) -> None:
        """Start the step that a process of `start.py` sends."""
        connection, _ = listener.accept()
        message, files, _, _ = socket.recv_fds(connection, 1 << 20, 3)
        while not message.endswith(b"\n"):
            message += connection.recv(1 << 20)
        process = os.fork()
        if process == 0:
            run(self, connection, json.loads(message), files)
        for file in files:
            os.close(file)
        self.running[process] = connection
        self.selector.register(connection, selectors.EVENT_READ, self.leave)

    def leave(self, connection: socket.socket) -> None:
        """Stop the step of a process of `start.py` that has been killed."""
        self.selector.unregister(connection)
        for process, other in self.running.items():
            if other is connection:
                os.kill(process, signal.SIGTERM)

    def finish(self, ended: socket.socket) -> None:
        """Send the exit status of each step that has ended."""
        ended.recv(1 << 10)
        while self.running:
            process, status = os.waitpid(-1, os.WNOHANG)
            if process == 0:
                return
            connection = self.running.pop(process)
            if connection in self.selector.get_map():
                self.selector.unregister(connection)
                connection.sendall(f"{os.waitstatus_to_exitcode(status)}\n".encode())
            connection.close()

    def end(self, _: int) -> None:
        """Stop all steps and this process."""
        for process in self.running:
            os.kill(process, signal.SIGTERM)
        self.path.unlink(missing_ok=True)
        sys.exit()


def run(steps: Steps, connection: socket.socket, step: dict, files: list[int]) -> None:
    """Run a script as `python` would, in the process of a step, and end the process."""
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    steps.selector.close()
    for own in (*steps.own, *steps.running.values(), connection):
        own.close()
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    os.chdir(step["folder"])
    os.environ.clear()
    os.environ.update(step["environment"])
    threads = int(step["environment"].get("OMP_NUM_THREADS", "1"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", numba.NumbaWarning)  # A library that is too old to be used.
        numba.set_num_threads(min(threads, numba.config.NUMBA_NUM_THREADS))
    sys.argv = step["command"][1:]
    sys.path[0] = os.path.dirname(sys.argv[0])  # noqa: PTH120
    code: object = 0
    try:
        runpy.run_path(sys.argv[0], run_name="__main__")
    except SystemExit as end:
        code = end.code
    except BaseException:
        traceback.print_exc()
        code = 1
    if isinstance(code, str):
        print(code, file=sys.stderr)
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else int(code is not None))


def prepare() -> None:
    """Import what steps import, and load the compiled functions that follow sampling.

    Sampling itself starts threads, which do not survive a fork.
    """
    for module in MODULES:
        importlib.import_module(module)
    for shape in ((6, 6), (4, 4, 4)):
        load_functions(shape)
    gc.collect()
    gc.freeze()


def load_functions(shape: tuple[int, ...]) -> None:
    """Find the topology of noise, mesh it, and check the mesh."""
    noise = np.random.default_rng(0).random([2 * n + 1 for n in shape])
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * len(shape))
    fractions = VolumeFractions.from_values(grid, 4, round_fractions(noise))
    find_persistence(fractions, name="noise")
    cells = CellSets(fractions, Policy()).at(0.5)
    judge(build_mesh(cells, grid, name="noise").mesh, cells.predicted)


if __name__ == "__main__":
    prepare()
    Steps(Path(sys.argv[1])).serve()
