"""What a pipeline is to the bench: a thing that takes frames, made by a factory, known by name."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from models.estimate import Estimate
from models.frame import Frame
from models.onboard import OnboardKnowledge


class Pipeline(Protocol):
    """One run of a pipeline: it keeps what it needs from frame to frame."""

    def process(self, frame: Frame) -> Estimate:
        """Say what a frame tells.

        Parameters
        ----------
        frame : Frame
            Later than the one before.

        Returns
        -------
        Estimate
            Of the frame's number and time: a pose, a state, or the reason why there is none.
        """
        ...


Factory: TypeAlias = Callable[[OnboardKnowledge, str], Pipeline]


@dataclass(frozen=True)
class RegisteredPipeline:
    """A pipeline that the bench can run.

    Attributes
    ----------
    name : str
        Small letters, digits, ``_`` and ``-``.
    make : callable
        ``make(onboard, variant)`` returns a pipeline that has seen no frame; it raises
        ``models.errors.DatasetError`` where it lacks something on board.
    streams : tuple of str
        Every frame must have these; it runs on no dataset without them.
    variants : tuple of str
        The sets of settings that it comes in.
    settings : callable, optional
        ``settings(variant)`` tells every setting as text: what was estimated with others is
        estimated again. Unless given, the text of the module in which ``make`` stands.
    label : callable, optional
        ``label(variant)``: what its estimates and its column in a score are called. Unless given,
        the name, and the variant where there are several.
    in_colour : bool
        Whether it is for images behind colour filters: among anybody's frames it takes part where
        their detector has such, the others where it has none.
    """

    name: str
    make: Factory
    streams: tuple[str, ...]
    variants: tuple[str, ...] = ("default",)
    settings: Callable[[str], str] | None = None
    label: Callable[[str], str] | None = None
    in_colour: bool = False

    def labelled(self, variant: str) -> str:
        """Return what a variant's estimates are called."""
        if self.label is not None:
            return self.label(variant)
        return self.name if len(self.variants) == 1 else f"{self.name}-{variant}"

    def settings_hash(self, variant: str) -> str:
        """Return a hash of every setting of a variant, or of the code where none are told."""
        if self.settings is not None:
            text = self.settings(variant)
        else:
            module = inspect.getmodule(self.make)
            try:
                text = variant + inspect.getsource(module) if module is not None else variant
            except (OSError, TypeError):
                text = variant
        return hashlib.sha256(text.encode()).hexdigest()
