"""A study's export as pandas tables with the data dictionary."""

from __future__ import annotations

import importlib.util
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import OptionError

if TYPE_CHECKING:
    import pandas

_DICTIONARY = "dictionary"


def read_tables(folder: str | PathLike[str]) -> dict[str, pandas.DataFrame]:
    """Every table in a folder that ``cohelm study export``, ``cohelm reproduce`` or ``cohelm sweep report`` wrote.

    Keys are the files' names without ending. Where Parquet lies beside the CSV of the same name it is read, if pyarrow is there
    (``pip install 'cohelm[study]'``): it keeps types. What the columns of a table mean is in ``frame.attrs["dictionary"]``:
    column -> {"meaning", "unit", "range", …}.
    """
    import pandas

    folder = Path(folder)
    endings = [".csv", ".parquet"] if importlib.util.find_spec("pyarrow") else [".csv"]
    files = {path.stem: path for ending in endings for path in sorted(folder.glob(f"*{ending}"))}
    if not files:
        raise OptionError(f"there are no tables in {folder}: expected files that end in {' or '.join(endings)}")
    tables = {
        name: pandas.read_parquet(path) if path.suffix == ".parquet" else pandas.read_csv(path)
        for name, path in files.items()
    }
    for name, frame in tables.items():
        meanings = _meanings(tables.get(_DICTIONARY), name)
        frame.attrs["dictionary"] = {column: meanings[column] for column in frame.columns if column in meanings}
    return tables


def _meanings(dictionary: pandas.DataFrame | None, table: str) -> dict[str, dict[str, str]]:
    if dictionary is None or "column" not in dictionary.columns:
        return {}
    rows = [{str(key): str(text) for key, text in row.items()} for row in dictionary.fillna("").to_dict("records")]
    mine = [row for row in rows if row.get("table", table) == table]
    return {row["column"]: {key: text for key, text in row.items() if key not in ("table", "column")} for row in mine}
