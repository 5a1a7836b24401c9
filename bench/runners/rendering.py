"""The verbs `render` and `run` on a cluster: frames by jobs, the rest by the command itself."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING

from bench.runners.arguments import typed_arguments
from bench.runners.chunks import Chunk
from bench.runners.options import NAMES, RunnerRequest, asked_of

if TYPE_CHECKING:
    from bench.verbs import Render


def rendered_share(verb: Render) -> Chunk | None:
    """Render the share that was typed, or have jobs render all that is missing.

    Parameters
    ----------
    verb : Render
        Or one that goes on from there.

    Returns
    -------
    Chunk or None
        The share, which is all that was asked; None where the verb has its own work still to do.

    Raises
    ------
    RvbenchError
        Each says what to do; nothing already rendered is lost.
    """
    runner, chunk = asked_of(verb, verb.threads)
    if runner is not None:
        _have_rendered(verb, runner)
    if chunk is None:
        return None
    from bench.runners.shared_case import frames_of
    from renders.batches.render_case import render_case
    from renders.scenario.scenario import RenderRequest

    request = RenderRequest(case=verb.case, out=verb.out, **verb.options())
    render_case(request, frames=frames_of(request, chunk))
    return chunk


def _have_rendered(verb: Render, runner: RunnerRequest) -> None:
    from bench.estimating.estimation import check_somebody_estimates
    from bench.runners.cluster_run import have_done
    from bench.runners.shared_case import case_work
    from bench.verbs import Render, Run
    from models.at_work import at_work
    from models.plain_console import plain_console
    from renders.batches.public_half import dataset_info
    from renders.scenario.scenario import RenderRequest, resolve
    from renders.variant.choice import choose_variant, short_name
    from renders.world.build import world_of

    # Of whatever verb, a job renders; frames of one dataset are of one kind of light.
    alone = Render(**{each.name: getattr(verb, each.name) for each in fields(Render)})
    variant = short_name(choose_variant(verb.variant))
    shared = replace(alone, variant=variant, threads=runner.workers)
    request = RenderRequest(case=verb.case, out=verb.out, **shared.options())
    if isinstance(verb, Run):
        check_somebody_estimates(dataset_info(world_of(resolve(request))))
    work = case_work(request, runner, typed_arguments("render", shared, NAMES))
    with at_work(verb.out, "render"):
        have_done(runner, work, plain_console(stderr=True))
