"""A dataset's description as Croissant 1.0 (MLCommons): JSON-LD that loaders understand."""

from __future__ import annotations

import json
from typing import Any

from bench.export.plan import Plan

CONFORMS_TO = "http://mlcommons.org/croissant/1.0"
CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "equivalentProperty": "cr:equivalentProperty",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "extract": "cr:extract",
    "field": "cr:field",
    "fileProperty": "cr:fileProperty",
    "fileObject": "cr:fileObject",
    "fileSet": "cr:fileSet",
    "format": "cr:format",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "samplingRate": "cr:samplingRate",
    "sc": "https://schema.org/",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}
KINDS = {str: "sc:Text", int: "sc:Integer", float: "sc:Float"}


def croissant(
    plan: Plan,
    licence: str,
    made_by: str,
    metadata: dict[str, tuple[int, str]],
    example: dict[str, Any],
) -> str:
    """Return the text of ``croissant.json``.

    Parameters
    ----------
    plan : Plan
    licence : str
        Nothing if it is not stated.
    made_by : str
    metadata : dict
        Size and SHA-256 of each split's JSON lines, by path in the export.
    example : dict
        A line of them, of which keys and kinds are taken.
    """
    cases = ", ".join(dict.fromkeys(source.dataset.info.case for source in plan.sources))
    table: dict[str, Any] = {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": CONFORMS_TO,
        "name": _identifier(cases),
        "description": (
            f"Rendered images of {', '.join(plan.object_ids)} with true poses, masks and "
            f"keypoints ({cases}). Made by {made_by}."
        ),
        "url": "https://localhost/" + _identifier(cases),
        "version": "1.0.0",
        "distribution": [_file(path, told) for path, told in metadata.items()],
        "recordSet": [_records(path, example) for path in metadata],
    }
    if licence:
        table["license"] = licence
    return json.dumps(table, indent=2) + "\n"


def _file(path: str, told: tuple[int, str]) -> dict[str, Any]:
    return {
        "@type": "cr:FileObject",
        "@id": path,
        "name": path,
        "contentUrl": path,
        "contentSize": f"{told[0]} B",
        "encodingFormat": "application/jsonlines",
        "sha256": told[1],
    }


def _records(path: str, example: dict[str, Any]) -> dict[str, Any]:
    split = path.split("/")[-2]
    return {
        "@type": "cr:RecordSet",
        "@id": split,
        "name": split,
        "field": [_field(path, split, key, value) for key, value in example.items()],
    }


def _field(path: str, split: str, key: str, value: Any) -> dict[str, Any]:
    kind = type(value[0]) if isinstance(value, list) and value else type(value)
    field: dict[str, Any] = {
        "@type": "cr:Field",
        "@id": f"{split}/{key}",
        "name": f"{split}/{key}",
        "dataType": KINDS.get(kind, "sc:Float"),
        "source": {"fileObject": {"@id": path}, "extract": {"column": key}},
    }
    if isinstance(value, list):
        field["repeated"] = True
    return field


def _identifier(text: str) -> str:
    kept = "".join(each if each.isalnum() and each.isascii() else "-" for each in text)
    return kept.strip("-")[:100] or "dataset"
