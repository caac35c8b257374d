"""A study's export as pandas tables with the data dictionary."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import OptionError

if TYPE_CHECKING:
    import pandas

_DICTIONARY = "dictionary"


def read_tables(folder: str | PathLike[str]) -> dict[str, pandas.DataFrame]:
    """Every table in a folder that ``cohelm study export``, ``cohelm reproduce`` or ``cohelm sweep report`` wrote.

    Keys are the files' names without ending. Parquet is read where it lies beside the CSV of the same name, which needs
    ``pip install 'cohelm[study]'``. Each column's meaning is in ``frame[column].attrs["meaning"]`` while pandas keeps it, and
    of all columns in ``frame.attrs["dictionary"]``: column -> {"meaning", "unit", "range", …}.
    """
    import pandas

    folder = Path(folder)
    files = {path.stem: path for ending in (".csv", ".parquet") for path in sorted(folder.glob(f"*{ending}"))}
    if not files:
        raise OptionError(f"there are no tables in {folder}: expected CSV or Parquet files")
    tables = {
        name: pandas.read_parquet(path) if path.suffix == ".parquet" else pandas.read_csv(path)
        for name, path in files.items()
    }
    meanings = _dictionary(tables.get(_DICTIONARY))
    for frame in tables.values():
        frame.attrs["dictionary"] = {column: meanings[column] for column in frame.columns if column in meanings}
    return tables


def _dictionary(frame: pandas.DataFrame | None) -> dict[str, dict[str, str]]:
    if frame is None or "column" not in frame.columns:
        return {}
    rows = frame.fillna("").astype(str).to_dict("records")
    return {str(row["column"]): {str(key): str(text) for key, text in row.items() if key != "column"} for row in rows}
