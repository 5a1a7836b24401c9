"""Which of Mitsuba's variants renders on this machine, and the one this process renders with.

A variant is tried in a subprocess (``probe_program``), since one that does not work may take its
process with it. One family serves everything: the ``*_rgb`` variants carry three bands in their
three channels at no more than the cost of one. Importing this file loads no Mitsuba.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from models.errors import VariantError
from renders.variant import probe_cache

VARIANTS = {"cuda": "cuda_ad_rgb", "llvm": "llvm_ad_rgb", "scalar": "scalar_rgb"}
"""The variants of the house by short name, the fastest first."""

SHORT_NAMES: tuple[Literal["cuda", "llvm", "scalar"], ...] = ("cuda", "llvm", "scalar")

PROBE_PROGRAM = Path(__file__).with_name("probe_program.py")
TIME_LIMIT_S = 120.0  # the first kernel of a loaded machine, or OptiX compiling its own
REASON_CHARACTERS = 200
MEANINGS = {
    "CUDA backend hasn't been initialized": "no CUDA driver or GPU found",
    "CUDA backend is inactive": "no CUDA driver or GPU found",
    "LLVM backend requires LLVM": "the libLLVM found is too old for Dr.Jit",
    "LLVM backend is inactive": "no libLLVM found",
    "Cannot select": "the libLLVM found cannot compile for this processor",
}
"""What Dr.Jit and LLVM say, and what it means here; the first that matches."""


@dataclass(frozen=True)
class ProbeResult:
    """What came of rendering a tiny scene with one variant.

    Attributes
    ----------
    variant : str
    renders : bool
        Whether the right picture came back.
    first_image_s : float, s
        From the start of the process to its first picture; 0 if none came.
    samples_per_s : float, 1/s
        Paths a second once the kernel is compiled, on a scene of two objects; 0 if none came.
    library : str
        The libLLVM or CUDA driver loaded; empty if none is needed or the system does not say.
    reason : str
        Why it does not render; empty if it does.
    """

    variant: str
    renders: bool
    first_image_s: float = 0.0
    samples_per_s: float = 0.0
    library: str = ""
    reason: str = ""


def probe(variant: str, *, fresh: bool = False, time_limit_s: float = TIME_LIMIT_S) -> ProbeResult:
    """Render a tiny scene with a variant, in a process of its own.

    The answer is kept for this process, and for a day on disk (``probe_cache``).

    Parameters
    ----------
    variant : str
        ``cuda``, ``llvm``, ``scalar``, or the variant's full name.
    fresh : bool
        Whether to render even if an answer is at hand.
    time_limit_s : float, s
        When to give up; an answer of "too slow" is not kept.

    Raises
    ------
    VariantError
        If the name is none of the house's variants.
    """
    name = full_name(variant)
    machine = probe_cache.fingerprint(PROBE_PROGRAM)
    if not fresh and (name, machine) in _answers:
        return _answers[name, machine]
    result = None if fresh else _recorded(name, machine)
    if result is None:
        result = _render(name, time_limit_s)
        if result.reason != _too_slow(time_limit_s):
            probe_cache.write(name, machine, asdict(result))
    _answers[name, machine] = result
    return result


def choose_variant(wanted: str = "auto") -> str:
    """Return the full name of a variant that renders here.

    Parameters
    ----------
    wanted : str
        ``auto`` takes the variant that this process already renders with, else the first of
        CUDA, LLVM and scalar that renders; any other name insists.

    Raises
    ------
    VariantError
        If the one insisted on does not render, or none does; the message says what to install.
    """
    if wanted != "auto":
        result = probe(wanted)
        if result.renders:
            return result.variant
        raise VariantError(
            f"expected {result.variant} to render on this machine, got: {result.reason}; "
            f"{remedy(result)}"
        )
    if active := active_variant():
        return active
    refusals = []
    for name in VARIANTS.values():
        result = probe(name)
        if result.renders:
            return name
        refusals.append(f"{name}: {result.reason}")
    raise VariantError(
        f"expected at least scalar_rgb to render, got {'; '.join(refusals)}; "
        f"{remedy(ProbeResult('scalar_rgb', renders=False))}"
    )


def activate(variant: str) -> None:
    """Set the variant of this process, once; the same one again is no harm.

    Objects of two variants do not mix, and modules that were imported under the first keep
    its types: hence never two in one process.

    Raises
    ------
    VariantError
        If another variant is set already, or this one cannot be.
    """
    name = full_name(variant)
    active = active_variant()
    if active == name:
        return
    if active is not None:
        raise VariantError(
            f"expected one variant in a process, got {name} after {active}; "
            "start another process for it"
        )
    try:
        import mitsuba

        mitsuba.set_variant(name)
    except ImportError as error:
        refused = ProbeResult(name, renders=False, reason=_last_words(str(error)))
        raise VariantError(
            f"expected {name} to load, got: {refused.reason}; {remedy(refused)}"
        ) from error


def active_variant() -> str | None:
    """Return the variant set in this process, or None; loads no Mitsuba to find out."""
    mitsuba = sys.modules.get("mitsuba")
    return mitsuba.variant() if mitsuba is not None else None


def full_name(variant: str) -> str:
    """Return ``llvm_ad_rgb`` for ``llvm``, and so on; a full name stands for itself.

    Raises
    ------
    VariantError
        If it is neither.
    """
    name = VARIANTS.get(variant, variant)
    if name not in VARIANTS.values():
        raise VariantError(
            f"expected a variant among auto, {', '.join(VARIANTS)} "
            f"(or {', '.join(VARIANTS.values())}), got {variant!r}"
        )
    return name


def short_name(variant: str) -> Literal["cuda", "llvm", "scalar"]:
    """Return ``llvm`` for ``llvm_ad_rgb``, and so on.

    Raises
    ------
    VariantError
        If it is none of the house's variants.
    """
    name = full_name(variant)
    return next(short for short in SHORT_NAMES if VARIANTS[short] == name)


def remedy(result: ProbeResult) -> str:
    """Return what to do about a variant that does not render, as one clause."""
    if result.variant == VARIANTS["cuda"]:
        return "it needs an NVIDIA GPU with driver 535 or newer (in a container, with `graphics`)"
    if result.variant == VARIANTS["scalar"]:
        return "install the house again (`make clean`, then the same command)"
    if path := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return f"DRJIT_LIBLLVM_PATH is {path!r}: point it to a libLLVM of 19 or newer, or unset it"
    return (
        "install libLLVM 19 or newer (`scripts/ensure_llvm.sh` does or says how), "
        "or choose the variant scalar, slower but correct"
    )


_answers: dict[tuple[str, str], ProbeResult] = {}


def _recorded(name: str, machine: str) -> ProbeResult | None:
    record = probe_cache.read(name, machine)
    try:
        return None if record is None else ProbeResult(**record)
    except TypeError:  # written by another version of the house
        return None


def _render(name: str, time_limit_s: float) -> ProbeResult:
    started = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="rvbench-probe-") as kernels:
        # its own kernel cache: a kernel that a better library compiled would hide a bad one
        environment = os.environ | {"DRJIT_CACHE_DIR": kernels}
        try:
            done = subprocess.run(
                [sys.executable, "-P", str(PROBE_PROGRAM), name],
                env=environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=time_limit_s,
            )
        except subprocess.TimeoutExpired:
            return ProbeResult(name, renders=False, reason=_too_slow(time_limit_s))
    if done.returncode != 0:
        return ProbeResult(name, renders=False, reason=_refusal(done.returncode, done.stderr))
    facts = json.loads(done.stdout.splitlines()[-1])
    return ProbeResult(
        name,
        renders=True,
        first_image_s=time.perf_counter() - started,
        samples_per_s=facts["samples_per_s"],
        library=facts["library"],
    )


def _too_slow(time_limit_s: float) -> str:
    return f"no picture within {time_limit_s:g} s"


def _refusal(code: int, errors: str) -> str:
    words = _last_words(errors) or "it said nothing"
    return words if code > 0 else f"{words} (its process died: {signal.strsignal(-code)})"


def _last_words(errors: str) -> str:
    """Return what a process's errors come to, in one readable line."""
    for sign, meaning in MEANINGS.items():
        if sign in errors:
            return meaning
    lines = [line.strip() for line in errors.splitlines() if line.strip()]
    telling = [line for line in lines if "LLVM ERROR" in line or "Error: " in line] or lines[-1:]
    return telling[0][:REASON_CHARACTERS].rstrip(".") if telling else ""
