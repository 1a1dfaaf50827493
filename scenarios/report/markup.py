"""HTML escaping of text and data, so that no content can end an element or swallow a script."""

import json
from html import escape
from typing import Any

from foreride.files.errors import printable

_ESCAPED = {ord(letter): f"\\u{ord(letter):04x}" for letter in "<>&"}


class Html(str):
    """Text that is already HTML; any other text is escaped when inserted into a page."""


def text(value: Any) -> Html:
    """Escape a value as text of an element or of a quoted attribute, in one line."""
    return value if isinstance(value, Html) else Html(escape(printable(value)))


def embedded(data: Any) -> Html:
    """Encode data as JSON for a script element: ASCII without the characters the HTML parser looks for."""
    return Html(json.dumps(data, allow_nan=False).translate(_ESCAPED))
