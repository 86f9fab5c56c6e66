"""Run a command: the script of a step in a copy of the process of `serve.py`, if that is ready.

Called as ``python -I -S start.py SOCKET COMMAND...``.  It imports little: each step starts it.
Compiled functions use as many threads as the step was given, which Snakemake states for OpenMP.
"""

import os
import sys


def main(path: str, command: list[str]) -> int:
    """Return the exit status of a command, whose standard streams are those of this process."""
    is_step = command[0] == sys.executable and len(command) == 2
    if not is_step or not os.path.exists(path):  # noqa: PTH110
        run_alone(command)
    import json
    import socket

    step = {"command": command, "folder": os.getcwd(), "environment": dict(os.environ)}  # noqa: PTH109
    with socket.socket(socket.AF_UNIX) as server:
        try:
            server.connect(path)
        except ConnectionRefusedError:  # The process was killed, and left its file.
            run_alone(command)
        message = json.dumps(step).encode() + b"\n"
        sent = socket.send_fds(server, [message], [0, 1, 2])
        server.sendall(message[sent:])
        answer = server.recv(64)
    if not answer:
        print(f"the process that runs {command[1]} has been stopped", file=sys.stderr)
        return 1
    code = int(answer)
    if code < 0:
        os.kill(os.getpid(), -code)
    return code


def run_alone(command: list[str]) -> None:
    """Become the command."""
    os.environ.setdefault("NUMBA_NUM_THREADS", os.environ.get("OMP_NUM_THREADS", "1"))
    os.execvp(command[0], command)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
