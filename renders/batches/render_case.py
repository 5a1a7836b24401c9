"""Render a case, exposure by exposure; stop it anywhere, and the same command goes on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Set

from rich.console import Console

from models.at_work import at_work
from models.dataset.description import DatasetInfo
from models.lights.eclipse import PENUMBRA, UMBRA, lighting
from models.plain_console import plain_console
from renders.batches.case_rendering import CaseRendering
from renders.batches.render_progress import render_progress
from renders.scenario.scenario import RenderRequest, Scenario
from renders.world.sun_paths import told
from renders.world.world import World

TYPED = ("fixed", "auto")  # modes of exposure that begin with what is typed


def render_case(
    request: RenderRequest,
    console: Console | None = None,
    frames: Set[int] | None = None,
    check: Callable[[DatasetInfo], None] | None = None,
) -> None:
    """Render what a request asks for and is not there yet.

    Parameters
    ----------
    request : RenderRequest
    console : Console, optional
        For progress.
    frames : set of int, optional
        These alone, and what is made of all exposures is left to who has them all.
    check : callable, optional
        ``check(info)``: raises what speaks against the dataset, before anything is written.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already rendered is lost.
    """
    case = CaseRendering(request)
    if check is not None:
        check(case.info)
    case.begin()
    with at_work(request.out, "render"):
        _render(case, request, console, frames)


def exposure_note(scenario: Scenario) -> str:
    """Tell what a typed exposure time comes to at another width; nothing where it is as typed.

    Parameters
    ----------
    scenario : Scenario
    """
    table, scale = scenario.exposure, scenario.pixel_scale
    if scale == 1.0 or scenario.frame_kind == "pairs" or table.mode not in TYPED:
        return ""
    return (
        f"exposure: {table.exposure_ms:g} ms as typed is meant for the chip's own pixels, "
        f"{scale**2 * table.exposure_ms:.3g} ms for these, {1.0 / scale:.3g} times as wide"
    )


def shadow_note(world: World) -> str:
    """Tell how many images are taken in the Earth's shadow; nothing where none is.

    Parameters
    ----------
    world : World
    """
    shares = {each.frame: world.sunlit_share(each.time_s) for each in world.exposures}
    met = Counter(lighting(share) for share in shares.values())
    if not met[UMBRA] and not met[PENUMBRA]:
        return ""
    return (
        f"the Earth's shadow: {met[UMBRA]} of {len(shares)} images are taken in the umbra, without "
        f"sunlight, {met[PENUMBRA]} in the penumbra"
    )


def _render(
    case: CaseRendering, request: RenderRequest, console: Console | None, frames: Set[int] | None
) -> None:
    case.start_renderer()
    console = console or plain_console(stderr=True)
    world = case.world
    kind = "image pairs" if len(world.bands) > 1 else "images"
    console.print(
        f"{world.scenario.name}, Sun {world.scenario.sun.default}: {case.info.frames} {kind} at "
        f"{world.camera.width} x {world.camera.height}, {case.variant}; "
        f"{len(case.there)} of {len(world.exposures)} exposures are there already; "
        f"{told(case.keys.sun_paths, len(world.suns))}",
        soft_wrap=True,
        markup=False,
    )
    for note in (exposure_note(world.scenario), shadow_note(world)):
        if note:
            console.print(note, soft_wrap=True, markup=False)
    left = [each for each in case.left if frames is None or each.frame in frames]
    wanted = frozenset(left)
    with render_progress(console) as track, case.claimed():
        for exposure in track(left, "render"):
            case.take_in_hand(exposure)
            case.render(exposure, wanted)
        if frames is not None:
            return
        if request.seeds > 1:  # other runs want the light of every frame, not only its image
            for exposure in track(case.there, "light"):
                case.take_in_hand(exposure)
                case.bring_back_light(exposure)
    case.finish()
