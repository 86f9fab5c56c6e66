"""Steps run in copies of one process: they behave as `python script.py` does."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

if sys.platform != "linux":
    pytest.skip("steps are copies of one process only on Linux", allow_module_level=True)

START = [sys.executable, "-I", "-S"]


@pytest.fixture
def server(repository, tmp_path, monkeypatch):
    """Start the process that copies itself, without the warm-up, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    code = "import sys; from pathlib import Path; from serve import Steps; Steps(Path('s')).serve()"
    paths = os.pathsep.join([str(repository / "workflow/steps"), str(repository)])
    environment = os.environ | {"PYTHONPATH": paths}
    process = subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, env=environment)
    wait_for(lambda: Path("s").exists())
    yield process
    process.stdin.close()
    assert process.wait(10) == 0
    assert not Path("s").exists()


@pytest.fixture
def command(repository):
    """Return a function that gives the command for a script of some code."""

    def command(code):
        Path("script.py").write_text(code)
        start = repository / "workflow/steps/start.py"
        return [*START, start, "s", sys.executable, "script.py"]

    return command


def wait_for(is_true):
    """Wait until something is true."""
    end = time.monotonic() + 60
    while not is_true():
        assert time.monotonic() < end
        time.sleep(0.02)


def run(command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=60, **options)


def has_ended(process):
    """Return whether no process has this id."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


SCRIPTS = [
    "import sys; print('out'); print('err', file=sys.stderr)",
    "import sys; sys.exit(3)",
    "import sys; sys.exit('what to do')",
    "import atexit; atexit.register(print, 'last')",
    "print(input() + '!')",
    "import os, sys; print(os.environ['STEP'], os.getcwd(), sys.argv, __name__)",
    "import os; print(len(os.environ['LONG']))",
]


def test_a_step_behaves_as_a_script_does(server, command):
    options = {"input": "line\n", "env": os.environ | {"STEP": "1", "LONG": "x" * 100_000}}
    for code in SCRIPTS:
        step, script = run(command(code), **options), run([sys.executable, "script.py"], **options)
        assert (step.returncode, step.stdout) == (script.returncode, script.stdout), code
        assert step.stderr == script.stderr, code


def test_steps_end_when_they_fail_or_are_killed(server, command):
    failed = run(command("import os; print(os.getppid(), flush=True); 1 / 0"))
    assert failed.returncode == 1
    assert "ZeroDivisionError" in failed.stderr
    assert int(failed.stdout) == server.pid, "the step did not run in a copy"

    killed = run(command("import os; os.kill(os.getpid(), 9)"))
    assert killed.returncode == -signal.SIGKILL

    sleep = command("import os, time; print(os.getpid(), flush=True); time.sleep(60)")
    with subprocess.Popen(sleep, stdout=subprocess.PIPE, text=True) as starter:
        step = int(starter.stdout.readline())
        starter.kill()
        wait_for(lambda: has_ended(step))

    with subprocess.Popen(
        sleep, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as other:
        step = int(other.stdout.readline())
        server.stdin.close()
        wait_for(lambda: has_ended(step))
        assert other.wait(10) == 1
        assert "has been stopped" in other.stderr.read()


def test_compiled_functions_use_the_threads_of_the_step(server, command):
    code = "import numba; print(numba.get_num_threads())"
    many = os.cpu_count()
    for start in (command(code), [a.replace("s", "no") if a == "s" else a for a in command(code)]):
        for threads in (1, many):
            environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
            environment.pop("NUMBA_NUM_THREADS", None)
            assert int(run(start, env=environment).stdout) == threads


def test_without_the_process_a_command_runs_as_it_is(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(command("import sys; print('alone'); sys.exit(4)")).returncode == 4
    assert run([*command("")[:-2], "echo", "other"]).stdout == "other\n"


def test_a_process_that_was_killed_is_not_waited_for(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as left:
        left.bind("s")
    assert run(command("print('alone')")).stdout == "alone\n"
