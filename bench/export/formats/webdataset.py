"""BOP as webdataset shards: tar files of up to a thousand images, shuffled by the recorded seed.

::

    OUT/train|val|test[_STREAM]/shard-000000.tar, ..., key_to_shard.json
        camera[_STREAM].json, dataset_info.json, test_targets_bop19.json, models/, ...

A shard holds what ``bop-imagewise`` writes of its images. Until the export is done each image's
files wait, so that a killed one goes on; they are packed at the end.
"""

from __future__ import annotations

import tarfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.export.formats.bop_check import check_webdataset
from bench.export.formats.bop_fields import root_files
from bench.export.formats.bop_imagewise import members
from bench.export.formats.format import Files, Format, Streamed
from bench.export.json_stream import entries
from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import Plan, Shot
from bench.export.records import HIDDEN, Records

NAME, TITLE = "webdataset", "BOP webdataset shards"
SHARD_IMAGES = 1000
SHUFFLE_SEED = 223
END = bytes(2 * tarfile.BLOCKSIZE)


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the files of one image, where they wait to be packed.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    record = label.record
    return {
        f"{HIDDEN}/staged/{record.key}/{name}": data
        for name, data in sorted(members(label, picture).items())
    }


def finish(records: Records) -> Streamed:
    """Return the shards, their index and the files beside them."""
    plan = records.plan
    yield from root_files(records, TITLE)
    for place, shots in sorted(_groups(plan).items()):
        order = np.random.default_rng([SHUFFLE_SEED, len(shots)]).permutation(len(shots))
        shuffled = [shots[int(number)] for number in order]
        for first in range(0, len(shuffled), SHARD_IMAGES):
            name = f"{place}/shard-{first // SHARD_IMAGES:06d}.tar"
            yield name, _shard(records, shuffled[first : first + SHARD_IMAGES])
        yield (
            f"{place}/key_to_shard.json",
            entries(
                (shot.image_key, number // SHARD_IMAGES) for number, shot in enumerate(shuffled)
            ),
        )


def _groups(plan: Plan) -> dict[str, list[Shot]]:
    groups: dict[str, list[Shot]] = {}
    for shot in plan.shots:
        groups.setdefault(f"{shot.split}{plan.suffix(shot.stream)}", []).append(shot)
    return groups


def _shard(records: Records, shots: list[Shot]) -> Iterator[bytes]:
    for shot in shots:
        record = records.get(shot)
        for path in sorted(record.files) if record is not None else ():
            data = (records.folder / path).read_bytes()
            yield from _member(f"{shot.image_key}.{Path(path).name}", data)
    yield END


def _member(name: str, data: bytes) -> Iterator[bytes]:
    """Return a file of a tar: no owner, no time, so that the same images make the same bytes."""
    entry = tarfile.TarInfo(name)
    entry.size, entry.mode = len(data), 0o644
    yield entry.tobuf(tarfile.USTAR_FORMAT)
    yield data
    yield bytes(-len(data) % tarfile.BLOCKSIZE)


FORMAT = Format(NAME, TITLE, 8, exposure, finish, check_webdataset, staged=True)
