"""A SLURM cluster of one node, this machine: started and stopped by a test."""

import os
import re
import shutil
import signal
import socket
import subprocess
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

COMMANDS = ["slurmctld", "slurmd", "sbatch", "scancel", "scontrol", "sinfo", "squeue", "srun"]
CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=1
ReturnToService=2
MinJobAge=3600
MaxArraySize=1001
InactiveLimit=0
KillWait=2
SlurmctldPort={controller}
SlurmdPort={daemon}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} RealMemory={megabytes} State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def what_is_missing():
    """Return why no cluster can be started here, or an empty string."""
    path = os.environ["PATH"] + os.pathsep + "/usr/sbin"
    missing = [name for name in ["munged", *COMMANDS] if shutil.which(name, path=path) is None]
    if missing:
        return f"SLURM is not installed: no {', '.join(missing)} (apt-get install slurm-wlm munge)"
    if find_spec("snakemake_executor_plugin_slurm") is None:
        return "Snakemake's plugin for SLURM is not installed (pip install '.[cluster]')"
    return ""


@contextmanager
def slurm_node(folder):
    """Run a cluster of this machine, and yield the environment variables of its users."""
    folder.mkdir(mode=0o755)
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    path = os.pathsep.join([str(folder / "bin"), os.environ["PATH"], "/usr/sbin"])
    environment = os.environ | {"PATH": path}
    add_commands(folder)
    (folder / "slurm.conf").write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0],
            user=subprocess.check_output(["id", "-un"], text=True).strip(),
            folder=folder,
            controller=free_port(),
            daemon=free_port(),
            processors=os.cpu_count(),
            megabytes=megabytes(),
        )
    )
    munge = [f"--{name}={folder}/munge.{name.split('-')[0]}" for name in ("socket", "pid-file")]
    munge += [f"--{name}={folder}/munge.{name.split('-')[0]}" for name in ("log-file", "seed-file")]
    commands = [
        ["munged", "--foreground", "--force", f"--key-file={key}", *munge],
        ["slurmctld", "-D", "-i"],
        ["slurmd", "-D"],
    ]
    processes = []
    try:
        for command in commands:
            log = (folder / f"{command[0]}.out").open("w")
            processes.append(
                subprocess.Popen(
                    command, env=environment, stdout=log, stderr=log, start_new_session=True
                )
            )
            if command[0] == "munged":
                wait_for(lambda: (folder / "munge.socket").exists(), folder)
        wait_for(lambda: "idle" in output(["sinfo", "-h", "-o", "%t"], environment), folder)
        yield environment
    finally:
        subprocess.run(["scancel", "--full", "--partition=main"], env=environment, check=False)
        time.sleep(1)
        for process in reversed(processes):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def add_commands(folder):
    """Add SLURM's commands for this cluster; Snakemake takes SLURM's variables from its jobs."""
    (folder / "bin").mkdir()
    path = os.environ["PATH"] + os.pathsep + "/usr/sbin"
    for name in COMMANDS:
        command = folder / "bin" / name
        command.write_text(
            f'#!/bin/sh\nSLURM_CONF={folder}/slurm.conf exec {shutil.which(name, path=path)} "$@"\n'
        )
        command.chmod(0o755)


def free_port():
    """Return a port that nothing listens to."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def megabytes():
    """Return half of the memory of this machine."""
    total = re.search(r"MemTotal:\s+(\d+)", Path("/proc/meminfo").read_text())
    return int(total[1]) // 2048


def output(command, environment):
    """Return what a command prints, also where it fails."""
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    return done.stdout


def wait_for(is_true, folder):
    """Wait until something is true; the logs say why it does not become so."""
    end = time.monotonic() + 120
    while not is_true():
        logs = "\n".join(
            p.read_text(errors="replace")[-2000:] for p in folder.glob("*.[lo][ou][gt]")
        )
        assert time.monotonic() < end, logs
        time.sleep(0.2)
