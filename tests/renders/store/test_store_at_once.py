"""Several processes on one store: each entry is whole or not there, and nobody fails."""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from models.arrays import Radiance
from renders.store.budget import stored
from renders.store.radiance_store import RadianceStore, entry_key
from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[3]
KEYS = [entry_key({"number": number}) for number in range(24)]
SHARED, OURS, THEIRS = KEYS[:8], KEYS[8:16], KEYS[16:]
LIMIT_BYTES = 60_000  # of entries of some 9 kB each: six of them

WRITE = """
import sys, json
from pathlib import Path
import numpy as np
from renders.store.radiance_store import RadianceStore
folder, limit, rounds, keys = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
store = RadianceStore(Path(folder), limit)
read = lost = 0
for _ in range(rounds):
    store.open_for_writing()  # sweeps away what is half written, if nobody is writing it
    for key in keys:
        image = np.random.default_rng(list(key.encode())).random((64, 64), dtype=np.float32)
        if store.has(key):
            back = store.read(key)
            lost += back is None
            read += back is not None
            assert back is None or (back == image.astype(np.float16)).all(), "other light"
            if back is not None:
                continue
        store.write(key, image)
print(json.dumps({"read": read, "lost": lost}))
"""
PRUNE = """
import sys, time
from bench.cli import main
while True:
    assert main(["store", "prune", "--to-gb", "1e-5", "--store", sys.argv[1]]) == 0
    assert main(["store", "verify", "--store", sys.argv[1]]) == 0
    assert main(["store", "list", "--store", sys.argv[1]]) == 0
    print(".", flush=True, file=sys.stderr)
"""


def start(program: str, *arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-P", "-c", program, *map(str, arguments)],
        cwd=HOUSE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def picture(key: str) -> Radiance:
    return np.random.default_rng(list(key.encode())).random((64, 64), dtype=np.float32)


def test_two_writers_a_pruner_and_a_reader_do_each_other_no_harm(tmp_path: Path) -> None:
    """The same keys and different ones, a budget too small for either, and pruning all along."""
    store = RadianceStore(tmp_path / "store")
    store.open_for_writing()
    pruner = start(PRUNE, store.folder)
    assert pruner.stderr is not None
    while pruner.stderr.readline() != ".\n":
        assert pruner.poll() is None
    writers = [start(WRITE, store.folder, LIMIT_BYTES, 12, *SHARED, *own) for own in (OURS, THEIRS)]
    seen, began_s = 0, time.monotonic()
    while any(writer.poll() is None for writer in writers):
        assert time.monotonic() - began_s < HANGS_S
        for key in KEYS:
            back = store.read(key)
            if back is not None:
                seen += 1
                np.testing.assert_array_equal(back, picture(key).astype(np.float16))
    counts = []
    for writer in writers:
        said, errors = writer.communicate()
        assert writer.returncode == 0, errors
        counts.append(json.loads(said))
    assert pruner.poll() is None, pruner.communicate()
    pruner.kill()
    _, errors = pruner.communicate()
    assert ".\n" in errors  # it pruned and verified meanwhile, and found no damage
    assert seen > 0
    assert sum(count["read"] for count in counts) > 0
    assert sum(entry.cost_bytes for entry in stored(store.folder)) <= LIMIT_BYTES
    assert not list(store.folder.rglob(".*.part"))


def test_a_claim_ends_with_its_process_however_that_ends(tmp_path: Path) -> None:
    from renders.store.claims import live_claims, read_claims

    program = (
        "import sys, time; from pathlib import Path\n"
        "from renders.store.radiance_store import RadianceStore\n"
        "from renders.store.claims import Claim\n"
        "claim = Claim('case', 'S2', Path('out'), frozenset(sys.argv[2:]), frozenset())\n"
        "with RadianceStore(Path(sys.argv[1])).claimed(claim):\n"
        "    print('held', flush=True)\n"
        "    time.sleep(600)\n"
    )
    store = RadianceStore(tmp_path / "store")
    store.write_all({key: picture(key) for key in KEYS[:6]})
    process = start(program, store.folder, *KEYS[:2])
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    (claim,) = live_claims(store.folder)
    assert claim.needed == frozenset(KEYS[:2])
    tight = RadianceStore(store.folder, limit_bytes=1.0)
    tight.write(KEYS[7], picture(KEYS[7]))
    assert [key for key in KEYS if store.has(key)] == KEYS[:2]
    process.kill()
    process.communicate()
    assert live_claims(store.folder) == []
    assert len(read_claims(store.folder)) == 1  # on record, and in nobody's way
    tight.write(KEYS[7], picture(KEYS[7]))
    assert not store.has(KEYS[0])
