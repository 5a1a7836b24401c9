"""Rerun's SDK as far as we use it, which draws nothing and remembers what it was given."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any


@dataclass(frozen=True)
class Shown:
    """One archetype or view: its name, and what it was made of."""

    kind: str
    given: tuple[Any, ...]
    named: dict[str, Any]


@dataclass
class Stream:
    """What was logged, in its order, each with the instants it was logged at."""

    application: str
    recording_id: str
    logged: list[tuple[tuple[str, ...], Shown, dict[str, float], bool]] = field(
        default_factory=list
    )
    now: dict[str, float] = field(default_factory=dict)
    layout: Shown | None = None

    def save(self, path: Path, default_blueprint: Shown) -> None:
        path.write_bytes(b"a recording")
        self.layout = default_blueprint

    def set_time(self, timeline: str, **instant: float) -> None:
        (self.now[timeline],) = instant.values()

    def log(self, entity: list[str], *shown: Shown, static: bool = False) -> None:
        assert all(isinstance(part, str) for part in entity)
        when = {} if static else dict(self.now)
        self.logged += [(tuple(entity), each, when, static) for each in shown]

    def disconnect(self) -> None:
        self.now = {"ended": 1.0}

    def of(self, kind: str, *entity: str) -> list[tuple[Shown, dict[str, float]]]:
        """Return what of one kind was logged at an entity."""
        return [
            (shown, when) for path, shown, when, _ in self.logged
            if shown.kind == kind and path == entity
        ]  # fmt: skip


class Sdk(ModuleType):
    """The module: any archetype can be made of anything."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.streams: list[Stream] = []
        self.__version__ = "0.41.0"

    def RecordingStream(self, application: str, recording_id: str) -> Stream:
        self.streams.append(Stream(application, recording_id))
        return self.streams[-1]

    def new_entity_path(self, parts: list[str]) -> tuple[str, ...]:
        return tuple(parts)

    def __getattr__(self, kind: str) -> Any:
        if kind.startswith("__"):
            raise AttributeError(kind)
        return lambda *given, **named: Shown(kind, given, named)


def install(monkeypatch) -> Sdk:
    """Put it where the real one would be."""
    sdk = Sdk("rerun")
    monkeypatch.setitem(sys.modules, "rerun", sdk)
    monkeypatch.setitem(sys.modules, "rerun.blueprint", Sdk("rerun.blueprint"))
    return sdk
