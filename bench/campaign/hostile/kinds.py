"""Every format that rvbench reads, and every folder that it goes on in."""

from __future__ import annotations

from bench.campaign.grounds import FORMAT, SUITE
from bench.campaign.hostile.kind import Kind

RENDER = ("--out", "made/out", "--store", "made/store")
SCORE = (
    "score",
    "pairs/data",
    "--estimates",
    "{file}",
    "--vsd-px",
    "0",
    "--out",
    "made/score.json",
)
COMPARE = (
    "compare", "pairs/data", "{file}", "--vsd-px", "0", "--resamples", "100", "--out", "made/c",
)  # fmt: skip
PUBLIC = ("dataset.json", "frames.csv", "camera.toml", "detector.toml", "markers.toml")
READERS = (
    ("score", "{data}"),
    ("report", "{data}"),
    ("show", "{data}", "0", "--out", "made/picture.png"),
    ("export", "{data}", "--as", FORMAT, "--out", "made/export"),
    ("compare", "{data}", "--vsd-px", "0", "--resamples", "100", "--out", "made/c"),
)
WRITES = ("score.json", "report.html", "estimates/*", "show/*")


def _readers(data: str) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(each.replace("{data}", data) for each in typed) for typed in READERS)


def _ours(data: str) -> tuple[str, ...]:
    return tuple(f"{data}/{pattern}" for pattern in WRITES)


def _estimates(name: str, file: str, file_format: str) -> Kind:
    typed = (*SCORE, "--format", file_format)
    return Kind(name, "pairs", (file,), (SCORE, typed, COMPARE), needed=True)


KINDS: tuple[Kind, ...] = (
    Kind(
        "scenario", "cases", ("small.toml", "turning.toml", "own.toml", "armed.toml"),
        (("render", "cases/{name}", *RENDER), ("run", "cases/{name}", *RENDER),
         ("sweep", "cases/{name}", "--time-s", "{time_s}", "--suns", "S2", *RENDER)),
        needed=True, share=3.0,
    ),
    Kind(
        "scenario's files", "cases", ("probe.toml", "markers.toml", "poses.csv", "probe.stl"),
        (("render", "cases/own.toml", *RENDER),), needed=True, share=2.0,
    ),
    Kind(
        "arm", "cases", ("arm.toml",), (("render", "cases/armed.toml", *RENDER),), needed=True,
    ),
    Kind(
        "URDF", "cases", ("arm.urdf",), (("render", "cases/urdf.toml", *RENDER),), needed=True,
    ),
    Kind(
        "dataset spec", "cases", ("spec.toml",),
        (("dataset", "cases/spec.toml", "--workers", "1", "--out", "made/out"),), needed=True,
        share=2.0,
    ),
    Kind(
        "spacecraft", "cases", ("probe.toml", "markers.toml"),
        (("inspect", "cases/probe.toml", "--out", "made"),),
    ),
    *(
        Kind(name, "cases", files, (("inspect", "{file}", "--out", "made"),), needed=True)
        for name, files in (
            ("GLB", ("look.glb",)), ("OBJ", ("look.obj",)),
            ("STL", ("look.stl", "look_text.stl")), ("PLY", ("look.ply", "look_text.ply")),
            ("glTF", ("look.gltf",)),
        )
    ),
    Kind(
        "glTF's buffers", "cases", ("gltf_buffer_*.bin",),
        (("inspect", "cases/look.gltf", "--out", "made"),), needed=True,
    ),
    _estimates("BOP results", "said.bop.csv", "bop"),
    _estimates("SPEED submission", "said.speed.csv", "speed"),
    _estimates("TUM trajectory", "said.tum", "tum"),
    _estimates("own estimates", "said.jsonl", "rvbench"),
    Kind(
        "dataset, public", "pairs", tuple(f"data/{name}" for name in (*PUBLIC, "prior.toml")),
        (("estimate", "pairs/data", "--time-limit-s", "20"), *_readers("pairs/data")),
        _ours("pairs/data"), share=2.0,
    ),
    Kind(
        "dataset, frames", "pairs", ("data/frames/*.png",),
        (("estimate", "pairs/data", "--time-limit-s", "20"), *_readers("pairs/data")),
        _ours("pairs/data"),
    ),
    Kind(
        "dataset, said", "pairs", ("data/estimates/*", "data/score.json"), _readers("pairs/data"),
        _ours("pairs/data"),
    ),
    Kind(
        "dataset, truth", "pairs", ("data/truth/*", "data/truth/*/*"), _readers("pairs/data"),
        _ours("pairs/data"), share=2.0,
    ),
    Kind(
        "anybody's frames", "pairs",
        ("data/frames/*.png", "data/camera.toml", "data/markers.toml", "data/prior.toml",
         "data/detector.toml"),
        (("estimate", "--frames", "pairs/data/frames", "--camera", "pairs/data/camera.toml",
          "--target", "pairs/data/markers.toml", "--prior", "pairs/data/prior.toml", "--detector",
          "pairs/data/detector.toml", "--out", "made"),),
        needed=True,
    ),
    Kind(
        "render, gone on with", "pairs", ("data/*", "data/*/*", "data/truth/*/*"),
        (("render", "cases/small.toml", "--out", "pairs/data", "--store", "pairs/store"),
         ("run", "cases/small.toml", "--out", "pairs/data", "--store", "pairs/store",
          "--seeds", "2")),
        ("pairs/data/*", "pairs/store/*"), beside=("cases",),
    ),
    Kind(
        "light store", "pairs", ("store/*", "store/*/*"),
        (("store", "list", "--store", "pairs/store"),
         ("store", "verify", "--store", "pairs/store"),
         ("store", "verify", "--delete", "--store", "pairs/store"),
         ("store", "prune", "--to-gb", "0.0001", "--store", "pairs/store"),
         ("render", "cases/small.toml", "--out", "made/out", "--store", "pairs/store")),
        ("pairs/store/*",), beside=("cases",),
    ),
    Kind(
        "random dataset", "random", ("data/*", "data/truth/*", "data/truth/*/*", "data/*/*"),
        (("dataset", "cases/spec.toml", "--workers", "1", "--out", "random/data"),),
        ("random/data/*",), beside=("cases",),
    ),
    Kind(
        "random dataset, whole", "drawn",
        ("data/*", "data/truth/*", "data/*/*", "data/*/frames/*", "data/*/truth/*"),
        (("export", "drawn/data", "--as", FORMAT, "--out", "made"),), full=True,
    ),
    Kind(
        "export", "export", ("data/*", "data/*/*", "data/*/*/*"),
        (("export", "--check", "--out", "export/data"),
         ("export", "pairs/data", "--as", FORMAT, "--out", "export/data"),
         ("score", "pairs/data", "--estimates", "pairs/said.bop.csv", "--vsd-px", "0", "--exported",
          "export/data", "--out", "made/score.json")),
        ("export/data/*",), beside=("pairs",), share=2.0,
    ),
    Kind(
        "tumble, both halves", "tumble", ("data/*", "data/truth/*", "data/estimates/*"),
        _readers("tumble/data"), _ours("tumble/data"), full=True, share=2.0,
    ),
    Kind(
        "tumble, estimated", "tumble",
        ("data/*.json", "data/*.csv", "data/*.toml", "data/frames/*.png"),
        (("estimate", "tumble/data", "--time-limit-s", "20"),), _ours("tumble/data"), full=True,
    ),
    Kind(
        "sweep, gone on with", "sweep", ("data/*", "data/*/*", "store/*/*"),
        (("sweep", "cases/small.toml", "--suns", "S2", "S3", "--time-s", "200", "--width", "64",
          "--threads", "1", "--out", "sweep/data", "--store", "sweep/store"),),
        ("sweep/data/*", "sweep/store/*"), beside=("cases",), full=True,
    ),
    Kind(
        "suite, gone on with", "suite", ("data/*", "data/units/*", "data/units/*/*"),
        ((*SUITE, "--workers", "1", "--out", "suite/data"),), ("suite/data/*",), full=True,
    ),
)  # fmt: skip
COMMAND_LINE = "command line"
