"""Data for a page in one file: JSON and numbers, compressed, as the text of a script.

A page that was opened from a disk may load scripts, and nothing else.
"""

from __future__ import annotations

import base64
import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_NONE = np.empty(0, np.float32)


def to_bytes(told: dict[str, Any], numbers: NDArray[np.float32] = _NONE) -> bytes:
    """Return JSON and numbers compressed: the length of the JSON, the JSON, four planes of bytes.

    The bytes of the numbers stand plane by plane, the first bytes of all of them, then the second
    ones: so they compress better.
    """
    text = json.dumps(told, separators=(",", ":")).encode()
    planes = np.ascontiguousarray(numbers).view(np.uint8).reshape(-1, 4).T
    return zlib.compress(len(text).to_bytes(4, "little") + text + planes.tobytes(), 9)


def unpack(data: bytes) -> tuple[dict[str, Any], NDArray[np.float32]]:
    """Return the JSON and the numbers of `to_bytes`, as the page reads them.

    Examples
    --------
    >>> told, numbers = unpack(to_bytes({"note": "two"}, np.float32([1.5, np.nan])))
    >>> told, numbers
    ({'note': 'two'}, array([1.5, nan], dtype=float32))
    """
    plain = zlib.decompress(data)
    end = 4 + int.from_bytes(plain[:4], "little")
    planes = np.frombuffer(plain[end:], np.uint8).reshape(4, -1)
    return json.loads(plain[4:end]), np.ascontiguousarray(planes.T).view(np.float32).ravel()


def rounded(numbers: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return numbers to one part in 65,000, so that they compress; no pixel moves.

    Examples
    --------
    >>> float(rounded(np.float32([1234.5678]))[0])
    1234.5625
    """
    bits = numbers.view(np.uint32)
    exact = (bits & 0xFF == 0) | ~np.isfinite(numbers)
    return np.where(exact, bits, (bits + 0x80) & 0xFFFFFF00).astype(np.uint32).view(np.float32)


def write_script(file: Path, data: bytes) -> None:
    """Write data as a script that hands them to living.js, under the name of the file."""
    text = f'arkaqLiving("{file.stem}", "{base64.b64encode(data).decode()}");\n'
    file.write_text(text, encoding="ascii")
