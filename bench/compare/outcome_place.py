"""Where a comparison may be written: nowhere that holds what is not ours."""

from __future__ import annotations

from pathlib import Path

from models.errors import DatasetError, UnreadableError
from models.output_folder import check_empty, check_place
from models.reading.json_file import read_json_table

FORMAT = "rvbench-comparison"
FILE_NAME, TABLE_NAME, PAGE_NAME = "comparison.json", "comparison.csv", "comparison.html"
MOST_BYTES = 4_000_000_000


def check_file_place(path: Path) -> None:
    """Refuse a place where a folder stands, or a file that is no comparison of ours.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    check_place(path.parent)
    if not path.exists() and not path.is_symlink():
        return
    try:
        ours = read_json_table(path, MOST_BYTES).get("format") == FORMAT
    except UnreadableError:
        ours = False
    if not ours:
        raise DatasetError(
            f"expected a comparison of ours or nothing at {path}, found what rvbench did not make; "
            "nothing was changed: choose another --out, or move it away"
        )


def check_folder_place(out: Path) -> None:
    """Refuse a folder that holds what no comparison of ours has made.

    Raises
    ------
    DatasetError, StorageError
        Nothing was changed.
    """
    check_place(out)
    own: set[str] = set()
    if (out / FILE_NAME).exists():
        check_file_place(out / FILE_NAME)
        own = {FILE_NAME, TABLE_NAME, PAGE_NAME}
    check_empty(out, "a comparison that rvbench made", own=own)
