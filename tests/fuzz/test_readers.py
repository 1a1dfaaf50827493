"""Whatever stands in place of a data file, its reader answers: a value, or one line that names the file."""

from pathlib import Path

import pytest

from tests.fuzz.readers import READERS


@pytest.mark.parametrize("name", READERS)
def test_the_valid_file_of_each_reader_is_read(name: str, tmp_path: Path) -> None:
    reader = READERS[name]
    path = reader.place(tmp_path)
    assert path.stat().st_size > 0
    reader.read(path)
