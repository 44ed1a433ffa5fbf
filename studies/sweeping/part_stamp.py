"""What a part says of the sweep that it belongs to, so that a folder with parts of another sweep is told from one that is whole."""

import hashlib
import json
from pathlib import Path

from studies.sweeping.row_log import TOLD, RowsError

LONGEST = 40  # characters of a value that a stamp holds itself; of a longer one it holds a hash


def stamp_of(meta: dict) -> dict[str, str]:
    """Names of all that the rows of a sweep depend on, with their values as short texts.

    Parameters
    ----------
    meta : what `meta.json` holds
    """
    told = {**meta.get("identity", {}), **{name: meta.get(name) for name in ("names", "rows", "library")}}
    flat = {}
    for name, value in told.items():
        flat |= {f"{name}.{key}": one for key, one in value.items()} if isinstance(value, dict) else {name: value}
    texts = {name: json.dumps(value, sort_keys=True) for name, value in flat.items()}
    return {
        name: text if len(text) <= LONGEST else f"#{hashlib.sha256(text.encode()).hexdigest()[:12]}" for name, text in texts.items()
    }


def check_stamp(path: Path, found: dict[str, str] | None, expected: dict[str, str]) -> None:
    """Refuse a part of another sweep; one of an earlier version of this library has no stamp.

    Raises
    ------
    RowsError : says what differs
    """
    if found is None or found == expected:
        return
    texts = []
    for name in found | expected:
        was, now = found.get(name, "not given"), expected.get(name, "not given")
        if was != now:
            hashed = was.startswith("#") or now.startswith("#")
            texts.append(f"{name} differs" if hashed else f"{name} was {was} and is {now}")
    more = f" and {len(texts) - TOLD} more" if len(texts) > TOLD else ""
    raise RowsError(
        f"All parts of a folder must be of one sweep, but {path} is of another: {', '.join(texts[:TOLD])}{more}; "
        "take the part away, or choose another folder."
    )
