"""A SLURM of two nodes on this machine, of daemons that are ours: no cgroup, no systemd."""

from __future__ import annotations

import os
import platform
import secrets
import shutil
import signal
import socket
import subprocess
import time
from contextlib import suppress
from pathlib import Path

from tests.support.patience import HANGS_S

NODES = ("node1", "node2")
DEAD_S = 10  # without a word, and a node counts as dead
CONFIGURATION = """
ClusterName=small
SlurmctldHost={machine}(127.0.0.1)
SlurmctldPort={port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
SlurmdSpoolDir={folder}/spool/%n
StateSaveLocation={folder}/state
SlurmdTimeout={dead_s}
SlurmctldTimeout={dead_s}
KillWait=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName=node[1-2] NodeHostname={machine} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def program(name: str) -> str | None:
    """Return where a program lies, daemons' folder included."""
    return shutil.which(name, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin")


class SmallSlurm:
    """Daemons that run until ``stop``.

    Parameters
    ----------
    folder : Path
        Of all that they write.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in ("munge", "state", "spool"):
            (folder / name).mkdir(parents=True)
        key = folder / "munge" / "key"
        key.write_bytes(secrets.token_bytes(1024))
        key.chmod(0o400)
        first = _free_ports(3)
        text = CONFIGURATION.format(
            machine=platform.node(), folder=folder, port=first, first=first + 1, last=first + 2,
            dead_s=DEAD_S,
        )  # fmt: skip
        self.configuration = folder / "slurm.conf"
        self.configuration.write_text(text)
        self.environment = {**os.environ, "SLURM_CONF": str(self.configuration)}
        munge = folder / "munge"
        _run([program("munged"), "--force", f"--key-file={key}", f"--socket={munge / 'socket'}",
              f"--pid-file={munge / 'pid'}", f"--log-file={munge / 'log'}",
              f"--seed-file={munge / 'seed'}"], self.environment)  # fmt: skip
        self.start_scheduler()
        for node in NODES:
            self.start_node(node)
        self.wait_for(lambda: self.states() == dict.fromkeys(NODES, "idle"))

    def start_scheduler(self) -> None:
        """Start it; it takes up what an earlier one of the folder left."""
        _run([program("slurmctld"), "-f", self.configuration], self.environment)

    def start_node(self, node: str) -> None:
        """Start it."""
        _run([program("slurmd"), "-N", node, "-f", self.configuration], self.environment)

    def kill_scheduler(self) -> None:
        """Kill it as a crash does."""
        _kill(self.folder / "slurmctld.pid")

    def kill_node(self, node: str) -> None:
        """Kill a node and all that runs on it, as a loss of power does."""
        _kill(self.folder / f"{node}.pid")
        for process in self._on(node):
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)

    def runs(self, node: str) -> bool:
        """Tell whether a job's process is at work on a node."""
        return bool(self._on(node))

    def states(self) -> dict[str, str]:
        """Return each node's state, without the marks that SLURM appends."""
        said = self.ask("sinfo", "--noheader", "--Node", "--format=%N %T")
        rows = [line.split() for line in said.splitlines()]
        return {node: state.rstrip("*~#!%$@^-") for node, state in rows}

    def ask(self, *command: str) -> str:
        """Return what one of SLURM's commands says; nothing if it cannot."""
        done = subprocess.run(
            command, env=self.environment, capture_output=True, text=True, check=False
        )
        return done.stdout

    def wait_for(self, is_so) -> None:
        """Return once something is so."""
        give_up_s = time.monotonic() + HANGS_S
        while not is_so():
            assert time.monotonic() < give_up_s
            time.sleep(0.2)

    def stop(self) -> None:
        """Stop all daemons, and what still runs."""
        self.ask("scancel", "--user=root")
        for node in NODES:
            self.kill_node(node)
        self.kill_scheduler()
        _kill(self.folder / "munge" / "pid")

    def _on(self, node: str) -> list[int]:
        """Return the processes of our jobs on a node, and those that watch over them."""
        found = []
        for place in Path("/proc").glob("[0-9]*"):
            try:
                environment = set((place / "environ").read_bytes().split(b"\0"))
                parent = int((place / "stat").read_text().rsplit(")", 1)[1].split()[1])
            except (OSError, IndexError, ValueError):
                continue
            ours = f"SLURM_CONF={self.configuration}".encode() in environment
            if ours and f"SLURMD_NODENAME={node}".encode() in environment:
                found += [int(place.name), *([parent] if _watches(parent) else [])]
        return found


def _watches(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes().startswith(b"slurmstepd")
    except OSError:
        return False


def _free_ports(count: int) -> int:
    """Return the first of some ports in a row that nobody listens to."""
    for first in range(46817, 60000, count):
        try:
            for port in range(first, first + count):
                with socket.socket() as own:
                    own.bind(("127.0.0.1", port))
        except OSError:
            continue
        return first
    raise AssertionError("no free ports")


def _run(command: list, environment: dict[str, str]) -> None:
    done = subprocess.run(
        [str(each) for each in command],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def _kill(pid_file: Path) -> None:
    """Kill the daemon that a file of ours names, and wait until it is gone."""
    with suppress(OSError, ValueError):
        process = int(pid_file.read_text())
        os.kill(process, signal.SIGKILL)
        while True:
            os.kill(process, 0)
            if Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z":
                return
            time.sleep(0.05)
