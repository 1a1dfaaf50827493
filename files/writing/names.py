"""Safe file names: one path component of characters that are valid on every system."""

import hashlib
import re
from collections.abc import Sequence

from foreride.files.errors import InputError, shown

MAX_LENGTH = 120
_SAFE = re.compile(r"[a-z0-9_][a-z0-9_.-]*")
_UNSAFE = re.compile(r"[^a-z0-9_.-]+")
_RESERVED = re.compile(r"(con|prn|aux|nul|com[0-9]|lpt[0-9])(\..*)?")
_DIGITS = 8


def component(text: str) -> str:
    """Convert text to the name of one file or folder: unchanged if safe, else made safe with a hash.

    Safe are lower-case ASCII letters, digits, `_`, `.`, `-`, not at the start or `.` at the end, at most
    `MAX_LENGTH` of them, and no reserved device name of Windows. Different texts give different names, even
    on file systems that ignore case.
    """
    if _is_safe(text):
        return text
    return _hashed(text, text)


def joined(shown: Sequence[str], meant: Sequence[str] = ()) -> str:
    """Join several texts with `-` to one component; different texts give different names.

    meant: the text that each stands for, if different. Only the first may contain a `-` without a hash.
    """
    text = "-".join(shown)
    unambiguous = _is_safe(shown[0]) and not any("-" in part for part in shown[1:])
    if unambiguous and _is_safe(text) and tuple(meant or shown) == tuple(shown):
        return text
    return _hashed(text, "\0".join(meant or shown))


def check_name(field: str, text: str) -> None:
    """Raise InputError unless the text can be a name: one line of visible text, not a path."""
    allowed = (
        f"1 ... {MAX_LENGTH} characters in one line, without / and \\, and not begin with a dot or space"
    )
    visible = text.isprintable() and text == text.strip() and not text.startswith(".")
    if not 0 < len(text) <= MAX_LENGTH or not visible or set(text) & set("/\\"):
        raise InputError(f"{field} must be {allowed}, got {shown(text)}")


def _is_safe(text: str) -> bool:
    valid_length = len(text) <= MAX_LENGTH and not text.endswith(".")
    return bool(valid_length and _SAFE.fullmatch(text) and not _RESERVED.fullmatch(text))


def _hashed(text: str, meaning: str) -> str:
    digest = hashlib.sha256(meaning.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGITS]
    stem = _UNSAFE.sub("_", text.lower()).lstrip(".-")[: MAX_LENGTH - _DIGITS - 2].rstrip(".")
    name = f"{stem or '_'}-{digest}"
    return f"_{name}" if _RESERVED.fullmatch(name) else name
