"""Command lines that nobody should type, made of those that one may."""

from __future__ import annotations

from numpy.random import Generator

VALUES = (
    "nan", "inf", "-inf", "1e400", "-1", "0", "1e308", "1e-320", "9" * 400, "0x10", "1_0", "1.5",
    "true", "None", "[]", "{}", " ", "\t", "\n", "x" * 5000, "../decoy/precious.txt", "/dev/zero",
    "/dev/null", "/", ".", "..", "~", "a\x01b", "\u202ea", "\udcff", "-", "--", "--help", "-h", "=",
    "a=b", "*", "S2", "S99", "0,0,0", "nan,0,1", "1,2", "270/95", "cases", "cases/small.toml",
    "pairs/data", "pairs", "pairs/said.tum", "decoy", "decoy/precious.txt", "made/x/y/z", "con",
    "xmm", "both", "best", "%s", "$HOME", "`id`", "[red]x[/red]", "18446744073709551616",
)  # fmt: skip
STORE = ("--store", "pairs/store")
LINES: tuple[tuple[str, ...], ...] = (
    ("render", "cases/small.toml", "--sun", "S3", "--rate-hz", "0.1", "--span-s", "200", "210",
     "--width", "64", "--spp", "4", "--store-budget-gb", "1", "--keep-light", "some",
     "--keep-every", "2", "--threads", "1", "--out", "made/o", *STORE),
    ("run", "maxar-demo", "--seeds", "2", "--variant", "llvm", "--out", "made/o", *STORE),
    ("sweep", "cases/small.toml", "--range-m", "3.7", "--suns", "S2", "270/45", "0.2,-0.5,1",
     "--exposure-ms", "0.05", "0.2", "--lamp-w-sr", "5", "--pipeline", "best", "--width", "64",
     "--spp", "2", "--marker-samples", "4", "--memory-gb", "1", "--out", "made/o", *STORE),
    ("sweep", "cases/small.toml", "--time-s", "200", "--sun-step-deg", "45", "--out", "made/o",
     *STORE),
    ("dataset", "cases/spec.toml", "--workers", "1", "--only", "0", "1", "--out", "made/o"),
    ("suite", "pesce2019", "--quick", "--parts", "table6", "--runs", "1", "--acquisitions", "2",
     "--seeds", "1", "--paper-runs", "1", "--duration-s", "60", "--workers", "1", "--seed", "3",
     "--out", "made/o"),
    ("estimate", "pairs/data", "--pipelines", "best", "--time-limit-s", "10"),
    ("estimate", "--frames", "pairs/data/frames", "--camera", "pairs/data/camera.toml", "--target",
     "pairs/data/markers.toml", "--prior", "pairs/data/prior.toml", "--rate-hz", "1", "--out",
     "made/e"),
    ("score", "pairs/data", "--fail-above-mm", "1000"),
    ("score", "pairs/data", "--estimates", "pairs/said.bop.csv", "--format", "bop", "--scene", "1",
     "--object", "1", "--trajectory-of", "camera", "--vsd-px", "8", "--out", "made/s.json"),
    ("compare", "pairs/data", "pairs/said.tum", "--dataset", "pairs/data", "--rank-by", "ar",
     "--vsd-px", "8", "--seed", "1", "--resamples", "100", "--block-frames", "1", "--out",
     "made/c"),
    ("report", "pairs/data"),
    ("show", "pairs/data", "1", "--variant", "paper", "--out", "made/p.png"),
    ("inspect", "cases/look.glb", "--out", "made"),
    ("inspect", "cases/probe.toml", "--out", "made"),
    ("export", "pairs/data", "--as", "coco", "--bits", "8", "--tone", "asinh", "--split", "0.8",
     "0.1", "0.1", "--split-seed", "1", "--split-block", "1", "--licence", "CC0", "--out",
     "made/e"),
    ("export", "--check", "--out", "export/data"),
    ("store", "list", *STORE),
    ("store", "verify", *STORE),
    ("store", "prune", "--to-gb", "1", *STORE),
    ("list",),
    ("--version",),
)  # fmt: skip


def typed_wrongly(random: Generator) -> tuple[list[str], str]:
    """Return a command line, and how it was spoilt.

    Parameters
    ----------
    random : Generator

    Returns
    -------
    list of str, str
    """
    line = list(LINES[int(random.integers(len(LINES)))])
    told = []
    for _ in range(int(random.integers(1, 4))):
        how = HOWS[int(random.integers(len(HOWS)))]
        place = int(random.integers(len(line))) if line else 0
        value = VALUES[int(random.integers(len(VALUES)))]
        told.append(how)
        if how == "value" and line:
            line[place] = value
        elif how == "missing" and line:
            del line[place]
        elif how == "twice" and line:
            line.insert(int(random.integers(len(line) + 1)), line[place])
        elif how == "added":
            line.insert(place, value)
        elif how == "cut" and line:
            line[place] = line[place][:-1]
        elif how == "joined" and line:
            line[place] = f"{line[place]}={value}"
    return line, ", ".join(told)


HOWS = ("value", "value", "value", "missing", "twice", "added", "cut", "joined")
