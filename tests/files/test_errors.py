"""Messages of bad input: one printable line, short, with both ends kept."""

from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import MESSAGE_LENGTH, InputError, abridged


@given(st.text(st.characters(), max_size=2000))
def test_every_message_is_one_short_printable_line(text: str) -> None:
    message = str(InputError(text))
    assert message.isprintable()
    assert len(message) < MESSAGE_LENGTH
    message.encode()


def test_a_long_message_keeps_the_file_and_what_is_wrong() -> None:
    message = str(InputError(f"road.yaml: {'x' * 10_000} must be a number, got ²"))
    assert message.startswith("road.yaml: xxx")
    assert message.endswith("xxx must be a number, got ²")


def test_short_texts_stay_as_they_are() -> None:
    assert abridged("short") == "short"
    assert len(abridged("x" * 1000, 50)) == 50
